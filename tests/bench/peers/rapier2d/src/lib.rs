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

/// Number of the new body, from 0. `place`: x, y, angle, velocity along x, angular velocity. `rest`: 0 never sleeps,
/// 1 may, 2 is asleep at the start.
#[no_mangle]
pub unsafe extern "C" fn peer_body(p: *mut Peer, dynamic: c_int, place: *const f64, rest: c_int) -> c_int {
    let p = &mut *p;
    let at = |k: usize| *place.add(k) as f32;
    let builder = if dynamic != 0 { RigidBodyBuilder::dynamic() } else { RigidBodyBuilder::fixed() };
    let body = builder
        .translation(Vector::new(at(0), at(1)))
        .rotation(at(2))
        .linvel(Vector::new(at(3), 0.0))
        .angvel(at(4))
        .can_sleep(rest != 0)
        .sleeping(rest == 2);
    p.bodies.push(p.world.bodies.insert(body));
    (p.bodies.len() - 1) as c_int
}

/// `size`: half edges and centre of a box; half height 0: a segment; half width 0: a disk of radius half height. With
/// corners: the convex hull of these points.
#[no_mangle]
pub unsafe extern "C" fn peer_shape(p: *mut Peer, body: c_int, size: *const f64, corners: c_int, corner: *const f64, density: f64, friction: f64, collide: c_int) {
    let p = &mut *p;
    let (hx, hy, center) = (*size as f32, *size.add(1) as f32, Vector::new(*size.add(2) as f32, *size.add(3) as f32));
    let shape = if corners > 0 {
        let at = |k: usize| Vector::new(*corner.add(2 * k) as f32, *corner.add(2 * k + 1) as f32);
        let points: Vec<_> = (0..corners as usize).map(at).collect();
        ColliderBuilder::convex_hull(&points).unwrap()
    } else if hx == 0.0 {
        ColliderBuilder::ball(hy).translation(center)
    } else if hy == 0.0 {
        let along = Vector::new(hx, 0.0);
        ColliderBuilder::segment(center - along, center + along)
    } else {
        ColliderBuilder::cuboid(hx, hy).translation(center)
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

/// x, y, angle, velocity, angular velocity.
#[no_mangle]
pub unsafe extern "C" fn peer_motion(p: *mut Peer, body: c_int, out: *mut f64) {
    let p = &*p;
    let body = &p.world.bodies[p.bodies[body as usize]];
    let (x, v) = (body.translation(), body.linvel());
    let all = [x.x, x.y, body.rotation().angle(), v.x, v.y, body.angvel()];
    for (k, value) in all.iter().enumerate() {
        *out.add(k) = *value as f64;
    }
}

#[no_mangle]
pub unsafe extern "C" fn peer_asleep(p: *mut Peer, body: c_int) -> c_int {
    let p = &*p;
    p.world.bodies[p.bodies[body as usize]].is_sleeping() as c_int
}
