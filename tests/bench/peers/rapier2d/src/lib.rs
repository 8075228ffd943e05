//! Rapier2d behind the few C functions that rigid2d_runner asks for: bodies, shapes, revolute joints, steps, poses.
use rapier2d::prelude::*;
use std::os::raw::c_int;

pub struct Peer {
    world: PhysicsWorld,
    bodies: Vec<RigidBodyHandle>,
}

#[no_mangle]
pub extern "C" fn peer_new(gx: f64, gy: f64) -> *mut Peer {
    let mut world = PhysicsWorld::new();
    world.gravity = Vector::new(gx as f32, gy as f32);
    Box::into_raw(Box::new(Peer { world, bodies: vec![] }))
}

/// Number of the new body, from 0. `asleep`: starts asleep and may sleep, otherwise never sleeps.
#[no_mangle]
pub unsafe extern "C" fn peer_body(p: *mut Peer, dynamic: c_int, x: f64, y: f64, vx: f64, asleep: c_int) -> c_int {
    let p = &mut *p;
    let builder = if dynamic != 0 { RigidBodyBuilder::dynamic() } else { RigidBodyBuilder::fixed() };
    let body = builder
        .translation(Vector::new(x as f32, y as f32))
        .linvel(Vector::new(vx as f32, 0.0))
        .can_sleep(asleep != 0)
        .sleeping(asleep == 1);
    p.bodies.push(p.world.bodies.insert(body));
    (p.bodies.len() - 1) as c_int
}

/// Box with half edges about (cx, cy); hy = 0: a segment; hx = 0: a disk of radius hy.
#[no_mangle]
pub unsafe extern "C" fn peer_shape(p: *mut Peer, body: c_int, hx: f64, hy: f64, cx: f64, cy: f64, density: f64, friction: f64, collide: c_int) {
    let p = &mut *p;
    let center = Vector::new(cx as f32, cy as f32);
    let shape = if hx == 0.0 {
        ColliderBuilder::ball(hy as f32).translation(center)
    } else if hy == 0.0 {
        let along = Vector::new(hx as f32, 0.0);
        ColliderBuilder::segment(center - along, center + along)
    } else {
        ColliderBuilder::cuboid(hx as f32, hy as f32).translation(center)
    };
    let mut shape = shape.density(density as f32).friction(friction as f32).restitution(0.0);
    if collide == 0 {
        shape = shape.collision_groups(InteractionGroups::none());
    }
    p.world.colliders.insert_with_parent(shape, p.bodies[body as usize], &mut p.world.bodies);
}

/// Anchors in the bodies' frames; a torque of 0 means no motor.
#[no_mangle]
pub unsafe extern "C" fn peer_revolute(p: *mut Peer, a: c_int, b: c_int, ax: f64, ay: f64, bx: f64, by: f64, speed: f64, torque: f64) {
    let p = &mut *p;
    let mut joint = RevoluteJointBuilder::new()
        .local_anchor1(Vector::new(ax as f32, ay as f32))
        .local_anchor2(Vector::new(bx as f32, by as f32))
        .contacts_enabled(false);
    if torque > 0.0 {
        joint = joint.motor_velocity(speed as f32, 1.0e8).motor_max_force(torque as f32);
    }
    p.world.insert_impulse_joint(p.bodies[a as usize], p.bodies[b as usize], joint);
}

#[no_mangle]
pub unsafe extern "C" fn peer_step(p: *mut Peer, dt: f64) {
    let p = &mut *p;
    p.world.integration_parameters.dt = dt as f32;
    p.world.step();
}

/// x, y, angle.
#[no_mangle]
pub unsafe extern "C" fn peer_pose(p: *mut Peer, body: c_int, out: *mut f64) {
    let p = &*p;
    let body = &p.world.bodies[p.bodies[body as usize]];
    *out = body.translation().x as f64;
    *out.add(1) = body.translation().y as f64;
    *out.add(2) = body.rotation().angle() as f64;
}
