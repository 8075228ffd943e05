//! Box2D v3 (crate boxdd-sys, which builds its C sources) behind the functions that rigid2d_runner asks for: bodies,
//! shapes, revolute joints, steps, poses. Four substeps a step and one thread, as in Box2D's own benchmark.
use boxdd_sys::ffi::*;
use std::os::raw::c_int;

pub struct Peer {
    world: b2WorldId,
    bodies: Vec<b2BodyId>,
}

fn vec(x: f64, y: f64) -> b2Vec2 {
    b2Vec2 { x: x as f32, y: y as f32 }
}

#[no_mangle]
pub unsafe extern "C" fn peer_new(gx: f64, gy: f64) -> *mut Peer {
    let mut def = b2DefaultWorldDef();
    def.gravity = vec(gx, gy);
    Box::into_raw(Box::new(Peer { world: b2CreateWorld(&def), bodies: vec![] }))
}

/// Number of the new body, from 0. `place`: x, y, angle, velocity along x, angular velocity. `rest`: 0 never sleeps,
/// 1 may, 2 is asleep at the start.
#[no_mangle]
pub unsafe extern "C" fn peer_body(p: *mut Peer, dynamic: c_int, place: *const f64, rest: c_int) -> c_int {
    let p = &mut *p;
    let at = |k: usize| *place.add(k);
    let mut def = b2DefaultBodyDef();
    def.type_ = if dynamic != 0 { b2BodyType_b2_dynamicBody } else { b2BodyType_b2_staticBody };
    def.position = vec(at(0), at(1));
    def.rotation = b2Rot { c: at(2).cos() as f32, s: at(2).sin() as f32 };
    def.linearVelocity = vec(at(3), 0.0);
    def.angularVelocity = at(4) as f32;
    def.enableSleep = rest != 0;
    def.isAwake = rest != 2;
    p.bodies.push(b2CreateBody(p.world, &def));
    (p.bodies.len() - 1) as c_int
}

/// `size`: half edges and centre of a box; half height 0: a segment; half width 0: a disk of radius half height. With
/// corners: the convex hull of these points.
#[no_mangle]
pub unsafe extern "C" fn peer_shape(p: *mut Peer, body: c_int, size: *const f64, corners: c_int, corner: *const f64, density: f64, friction: f64, collide: c_int) {
    let body = (&*p).bodies[body as usize];
    let (hx, hy, cx, cy) = (*size, *size.add(1), *size.add(2), *size.add(3));
    let mut def = b2DefaultShapeDef();
    def.density = density as f32;
    def.material.friction = friction as f32;
    def.material.restitution = 0.0;
    if collide == 0 {
        def.filter.maskBits = 0;
    }
    if corners > 0 {
        let points: Vec<b2Vec2> = (0..corners as usize).map(|k| vec(*corner.add(2 * k), *corner.add(2 * k + 1))).collect();
        let hull = b2ComputeHull(points.as_ptr(), corners);
        b2CreatePolygonShape(body, &def, &b2MakePolygon(&hull, 0.0));
    } else if hx == 0.0 {
        b2CreateCircleShape(body, &def, &b2Circle { center: vec(cx, cy), radius: hy as f32 });
    } else if hy == 0.0 {
        b2CreateSegmentShape(body, &def, &b2Segment { point1: vec(cx - hx, cy), point2: vec(cx + hx, cy) });
    } else {
        let unturned = b2Rot { c: 1.0, s: 0.0 };
        b2CreatePolygonShape(body, &def, &b2MakeOffsetBox(hx as f32, hy as f32, vec(cx, cy), unturned));
    }
}

/// Anchors in the bodies' frames; a torque of 0 means no motor.
#[no_mangle]
pub unsafe extern "C" fn peer_revolute(p: *mut Peer, a: c_int, b: c_int, ax: f64, ay: f64, bx: f64, by: f64, speed: f64, torque: f64) {
    let p = &*p;
    let mut def = b2DefaultRevoluteJointDef();
    def.base.bodyIdA = p.bodies[a as usize];
    def.base.bodyIdB = p.bodies[b as usize];
    def.base.localFrameA.p = vec(ax, ay);
    def.base.localFrameB.p = vec(bx, by);
    def.enableMotor = torque > 0.0;
    def.motorSpeed = speed as f32;
    def.maxMotorTorque = torque as f32;
    b2CreateRevoluteJoint(p.world, &def);
}

#[no_mangle]
pub unsafe extern "C" fn peer_step(p: *mut Peer, dt: f64) {
    b2World_Step((&*p).world, dt as f32, 4);
}

/// x, y, angle, velocity, angular velocity.
#[no_mangle]
pub unsafe extern "C" fn peer_motion(p: *mut Peer, body: c_int, out: *mut f64) {
    let body = (&*p).bodies[body as usize];
    let (at, q, v) = (b2Body_GetPosition(body), b2Body_GetRotation(body), b2Body_GetLinearVelocity(body));
    let angle = (q.s as f64).atan2(q.c as f64);
    let all = [at.x as f64, at.y as f64, angle, v.x as f64, v.y as f64, b2Body_GetAngularVelocity(body) as f64];
    for (k, value) in all.iter().enumerate() {
        *out.add(k) = *value;
    }
}

#[no_mangle]
pub unsafe extern "C" fn peer_asleep(p: *mut Peer, body: c_int) -> c_int {
    let body = (&*p).bodies[body as usize];
    !b2Body_IsAwake(body) as c_int
}
