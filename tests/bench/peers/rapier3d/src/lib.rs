//! Rapier3d behind the few C functions that rigid3d_runner asks for: bodies, ball joints, steps, motion.
use rapier3d::prelude::*;
use std::os::raw::c_int;

pub struct Peer {
    world: PhysicsWorld,
    bodies: Vec<RigidBodyHandle>,
}

unsafe fn vector(p: *const f64) -> Vector {
    Vector::new(*p as f32, *p.add(1) as f32, *p.add(2) as f32)
}

#[no_mangle]
pub unsafe extern "C" fn peer_new(gravity: *const f64) -> *mut Peer {
    let mut world = PhysicsWorld::new();
    world.gravity = vector(gravity);
    Box::into_raw(Box::new(Peer { world, bodies: vec![] }))
}

/// Sizes by shape: box (0) half edges, sphere (1) radius, capsule along y (2) radius and half length, hull
/// (3) the number of its points and their coordinates. The pose is
/// position and quaternion (w first), the motion velocity and angular velocity. What does not collide has no shape,
/// only `mass` and its moments.
#[no_mangle]
pub unsafe extern "C" fn peer_body(p: *mut Peer, shape: c_int, size: *const f64, pose: *const f64, motion: *const f64, fixed: c_int, collide: c_int, may_sleep: c_int, density: f64, friction: f64, mass: f64, moments: *const f64) {
    let p = &mut *p;
    let f = |k: usize| *size.add(k) as f32;
    let q = |k: usize| *pose.add(3 + k) as f32;
    let builder = if fixed != 0 { RigidBodyBuilder::fixed() } else { RigidBodyBuilder::dynamic() };
    let mut body = builder
        .pose(Pose::from_parts(vector(pose), Rotation::from_xyzw(q(1), q(2), q(3), q(0))))
        .linvel(vector(motion))
        .angvel(vector(motion.add(3)))
        .can_sleep(may_sleep != 0)
        .gyroscopic_forces_enabled(true);
    if collide == 0 {
        if fixed == 0 {
            body = body.additional_mass_properties(MassProperties::new(Vector::ZERO, mass as f32, vector(moments)));
        }
        p.bodies.push(p.world.bodies.insert(body));
        return;
    }
    let collider = match shape {
        0 => ColliderBuilder::cuboid(f(0), f(1), f(2)),
        1 => ColliderBuilder::ball(f(0)),
        2 => ColliderBuilder::capsule_y(f(1), f(0)),
        _ => {
            let points: Vec<_> = (0..*size as usize).map(|k| vector(size.add(1 + 3 * k))).collect();
            ColliderBuilder::convex_hull(&points).unwrap()
        }
    };
    let collider = collider.density(density as f32).friction(friction as f32).restitution(0.0);
    let (handle, _) = p.world.insert(body, collider);
    p.bodies.push(handle);
}

/// Anchors in the bodies' frames; what is joined does not touch.
#[no_mangle]
pub unsafe extern "C" fn peer_ball(p: *mut Peer, a: c_int, b: c_int, on_a: *const f64, on_b: *const f64) {
    let p = &mut *p;
    let joint = SphericalJointBuilder::new().local_anchor1(vector(on_a)).local_anchor2(vector(on_b)).contacts_enabled(false);
    p.world.insert_impulse_joint(p.bodies[a as usize], p.bodies[b as usize], joint);
}

#[no_mangle]
pub unsafe extern "C" fn peer_step(p: *mut Peer, dt: f64) {
    let p = &mut *p;
    p.world.integration_parameters.dt = dt as f32;
    p.world.step();
}

/// Position, quaternion (w first), velocity, angular velocity.
#[no_mangle]
pub unsafe extern "C" fn peer_motion(p: *mut Peer, body: c_int, out: *mut f64) {
    let p = &*p;
    let body = &p.world.bodies[p.bodies[body as usize]];
    let (x, q, v, w) = (body.translation(), body.rotation(), body.linvel(), body.angvel());
    let all = [x.x, x.y, x.z, q.w, q.x, q.y, q.z, v.x, v.y, v.z, w.x, w.y, w.z];
    for (k, value) in all.iter().enumerate() {
        *out.add(k) = *value as f64;
    }
}

#[no_mangle]
pub unsafe extern "C" fn peer_asleep(p: *mut Peer, body: c_int) -> c_int {
    let p = &*p;
    p.world.bodies[p.bodies[body as usize]].is_sleeping() as c_int
}
