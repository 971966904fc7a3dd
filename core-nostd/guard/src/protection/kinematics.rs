//! Braking and field length (book, Guard: Field length).

/// Distance until standstill, metres: `v·t_r + ½·a·t_r² + (v + a·t_r)²/(2·b)`; the middle and the sum cover a robot
/// that still accelerates while the response time runs. Infinite when the braking is not positive.
///
/// ```
/// use floorguard_guard::stop_distance_m;
///
/// // 1 m/s, 0.2 s until the brake bites, 1 m/s²: 0.2 m of delay and 0.5 m of braking.
/// assert!((stop_distance_m(1.0, 0.2, 0.0, 1.0) - 0.7).abs() < 1.0e-6);
/// assert_eq!(stop_distance_m(1.0, 0.2, 0.0, 0.0), f32::INFINITY);
/// ```
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
///
/// ```
/// use floorguard_guard::field_length_m;
///
/// // 0.5 m/s, 0.23 s until scanner and brake respond, 0.8 m/s², and 0.1 m for the scanner's errors.
/// let length_m = field_length_m(0.5, 0.23, 0.8, 0.1);
/// assert!((length_m - (0.115 + 0.15625 + 0.1)).abs() < 1.0e-6);
/// ```
#[must_use]
pub fn field_length_m(speed_mps: f32, response_s: f32, braking_mps2: f32, supplements_m: f32) -> f32 {
    stop_distance_m(speed_mps, response_s, 0.0, braking_mps2) + supplements_m
}
