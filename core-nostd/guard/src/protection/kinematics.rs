//! Braking and field length (book, Guard: Field length).

/// Distance until standstill, metres: `v·t_r + ½·a·t_r² + (v + a·t_r)²/(2·b)`; the middle and the sum cover a robot
/// that still accelerates while the response time runs. Infinite when the braking is not positive.
#[must_use]
pub fn stop_distance_m(speed_mps: f32, response_s: f32, acceleration_mps2: f32, braking_mps2: f32) -> f32 {
    if braking_mps2 <= 0.0 {
        return f32::INFINITY;
    }
    let fastest = speed_mps + acceleration_mps2 * response_s;
    let delay = speed_mps * response_s + 0.5 * acceleration_mps2 * response_s * response_s;
    delay + fastest * fastest / (2.0 * braking_mps2)
}

/// Least length of a protective field beyond the body, metres:
/// `S_L = v·(T_S + T_M) + v²/(2·b) + supplements` (book, Guard: Field length).
#[must_use]
pub fn field_length_m(speed_mps: f32, response_s: f32, braking_mps2: f32, supplements_m: f32) -> f32 {
    stop_distance_m(speed_mps, response_s, 0.0, braking_mps2) + supplements_m
}
