//! Series and parallel assembly of compliances, reflection to the input, twist (Eqs. 11-13).

/// Eq. (11): `C_OS = C_OS^t + C_OP / N_OP` (rad/(N m)).
#[inline(always)]
#[must_use]
pub fn output_compliance(shaft: f64, pin: f64, pins: f64) -> f64 {
    shaft + pin / pins
}

/// Compliance with the pins' share by statics: `C_OS^t + C_OP / (N_OP p)` (rad/(N m)).
#[inline(always)]
#[must_use]
pub fn output_compliance_statics(shaft: f64, pin: f64, pins: f64, participation: f64) -> f64 {
    shaft + pin / (pins * participation)
}

/// Eq. (12): `C*_OS = C_OS i^2` (rad/(N m) at the input).
#[inline(always)]
#[must_use]
pub fn reflected(compliance: f64, ratio_squared: f64) -> f64 {
    compliance * ratio_squared
}

/// Eq. (13): twist at the input (deg) under n times the nominal torque,
/// `eta (C* n T_N) 180/pi + gamma`, for a load not below zero. A negative load twists to the other
/// side by as much.
///
/// The whole compliance is multiplied by eta: fewer active pins then mean less twist. An
/// optimiser will exploit it.
#[inline(always)]
#[must_use]
pub fn twist_deg(slope_deg: f64, load: f64, free_play_deg: f64) -> f64 {
    slope_deg * load + free_play_deg
}

/// Twist (deg) at the input for one nominal torque beyond the free play,
/// `eta C* T_N 180/pi`; with a measured stiffness or by statics, eta is one.
#[inline(always)]
#[must_use]
pub fn slope_deg(efficiency: f64, reflected: f64, nominal_torque: f64) -> f64 {
    (efficiency * (reflected * nominal_torque)).to_degrees()
}

/// First natural frequency (Hz) of an inertia at the input against the locked output,
/// `sqrt(K* / J) / (2 pi)`.
#[inline(always)]
#[must_use]
pub fn natural_frequency(reflected_stiffness: f64, inertia: f64) -> f64 {
    (reflected_stiffness / inertia).sqrt() * std::f64::consts::TAU.recip()
}
