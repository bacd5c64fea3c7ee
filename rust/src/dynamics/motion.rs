//! The motion of a linear branch in closed form, mode by mode.

/// Angle (rad) over which a mode is no longer taken for a parabola.
const TURNS: f64 = 1.5;

/// One mode under a force that changes linearly in time, from the moment at which a branch starts.
///
/// $\ddot q + c \dot q + \omega^2 q = f_0 + f_1 t$ with $c = \beta \omega^2$.
#[derive(Debug, Clone, Copy)]
pub(super) struct ModeMotion {
    /// Angular frequency squared (1/s^2), zero for a rigid mode.
    square: f64,
    /// Half of the damping coefficient (1/s).
    decay: f64,
    /// Angular frequency of the damped oscillation, or rate where it creeps back.
    omega: f64,
    /// Whether it creeps back without oscillating.
    creeps: bool,
    /// Part of the solution that the force alone makes: constant and slope; for a rigid mode the
    /// force's.
    steady: (f64, f64),
    /// Displacement and speed at the start, the steady part taken off.
    start: (f64, f64),
}

impl ModeMotion {
    /// A mode from displacement and speed at the start and the force's value and slope.
    pub(super) fn new(square: f64, damping_s: f64, start: (f64, f64), force: (f64, f64)) -> Self {
        if square == 0.0 {
            return Self {
                square,
                decay: 0.0,
                omega: 0.0,
                creeps: false,
                steady: force,
                start,
            };
        }
        let decay = 0.5 * damping_s * square;
        let excess = square - decay * decay;
        let slope = force.1 / square;
        let constant = force.0 / square - 2.0 * decay * slope / square;
        Self {
            square,
            decay,
            omega: excess.abs().sqrt(),
            creeps: excess < 0.0,
            steady: (constant, slope),
            start: (start.0 - constant, start.1 - slope),
        }
    }

    /// Displacement and speed after a time (s).
    pub(super) fn at(&self, time: f64) -> (f64, f64) {
        let (from, speed) = self.start;
        if self.square == 0.0 {
            let (f0, f1) = self.steady;
            let half = 0.5 * f0 * time;
            let sixth = f1 * time * time / 6.0;
            return (
                from + time * (speed + half + sixth),
                speed + 2.0 * half + 3.0 * sixth,
            );
        }
        let (cosine, sine) = self.free(time);
        let (constant, slope) = self.steady;
        let drive = speed + self.decay * from;
        (
            constant + slope * time + from * cosine + drive * sine,
            slope + speed * cosine - (self.square * from + self.decay * speed) * sine,
        )
    }

    /// Fading cosine, and fading sine over the frequency; hyperbolic where the mode creeps back.
    fn free(&self, time: f64) -> (f64, f64) {
        if self.creeps {
            let slow = ((self.omega - self.decay) * time).exp();
            let fast = (-(self.omega + self.decay) * time).exp();
            return (0.5 * (slow + fast), 0.5 * (slow - fast) / self.omega);
        }
        let fade = if self.decay == 0.0 {
            1.0
        } else {
            (-self.decay * time).exp()
        };
        if self.omega == 0.0 {
            return (fade, fade * time);
        }
        let (sine, cosine) = (self.omega * time).sin_cos();
        (fade * cosine, fade * sine / self.omega)
    }

    /// What the acceleration never exceeds within a time (s).
    pub(super) fn acceleration_bound(&self, time: f64) -> f64 {
        if self.square == 0.0 {
            return self.steady.0.abs() + self.steady.1.abs() * time;
        }
        self.rate() * self.root_of_energy()
    }

    /// Speed of the free part, which never exceeds it: the root of its energy never grows.
    fn root_of_energy(&self) -> f64 {
        let (from, speed) = self.start;
        (speed * speed + self.square * from * from).sqrt()
    }

    /// Rate (1/s) at which the derivatives of the free part grow at most.
    fn rate(&self) -> f64 {
        self.square.sqrt() + 2.0 * self.decay
    }

    /// Displacement and its first two derivatives as a parabola around a time, and the distance
    /// from it that is never exceeded within a radius; true when the parabola touches the motion.
    ///
    /// A mode that turns more than once in the stretch is only known to stay within its amplitude.
    pub(super) fn around(&self, time: f64, radius: f64) -> ([f64; 3], f64, bool) {
        let cube = radius * radius * radius / 6.0;
        if self.square == 0.0 {
            let (displacement, speed) = self.at(time);
            let parabola = [displacement, speed, self.steady.0 + self.steady.1 * time];
            return (parabola, self.steady.1.abs() * cube, true);
        }
        let (constant, slope) = self.steady;
        let (rate, energy) = (self.rate(), self.root_of_energy());
        if rate * radius > TURNS {
            let amplitude = energy / self.square.sqrt();
            return ([constant + slope * time, slope, 0.0], amplitude, false);
        }
        let (displacement, speed) = self.at(time);
        let (free, free_speed) = (displacement - constant - slope * time, speed - slope);
        let acceleration = -self.square * free - 2.0 * self.decay * free_speed;
        let parabola = [displacement, speed, acceleration];
        (parabola, rate * rate * energy * cube, true)
    }
}
