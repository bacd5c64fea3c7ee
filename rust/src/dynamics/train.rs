//! What a torsional train is made of: inertias, springs, slip elements.

use thiserror::Error;

/// Why a train, or the torques on it, cannot be taken.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum TrainError {
    /// A number of the train is not what it must be.
    #[error("{what} {number}: found {found}, expected {expected}")]
    Number {
        /// Which list.
        what: &'static str,
        /// Place in the list, from 1.
        number: usize,
        /// The number.
        found: f64,
        /// What it must be.
        expected: &'static str,
    },
    /// Lists that belong together differ in length.
    #[error("{what}: found {found} entries, expected {expected}")]
    Length {
        /// Which list.
        what: &'static str,
        /// Its length.
        found: usize,
        /// The length it must have.
        expected: usize,
    },
    /// A spring does not join two different nodes of the train.
    #[error(
        "spring {number}: it must join two different nodes of the train, or a node and the ground"
    )]
    Ends {
        /// Place of the spring, from 1.
        number: usize,
    },
    /// Events follow each other without time passing.
    #[error(
        "{events} events at {time_s} s without time passing: the train switches to and fro between two branches"
    )]
    Stuck {
        /// How many.
        events: usize,
        /// When (s).
        time_s: f64,
    },
}

/// Friction in parallel to a spring: a spring of its own that slides at a limit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SlipElement {
    /// Stiffness while it holds (N m/rad).
    pub stiffness: f64,
    /// Torque at which it slides without load (N m).
    pub limit: f64,
    /// What the limit grows by for one unit of the elastic torque of its spring.
    pub load_factor: f64,
}

/// A spring between two nodes: a law of straight lines, and slip elements in parallel.
#[derive(Debug, Clone, PartialEq)]
pub struct Spring {
    /// Node whose angle counts positive for the twist.
    pub from: usize,
    /// Node whose angle counts negative; none for the ground.
    pub to: Option<usize>,
    /// Twists (rad) at which the slope of the law changes, rising.
    pub knees: Vec<f64>,
    /// Slopes (N m/rad) before, between and behind the knees.
    pub slopes: Vec<f64>,
    /// A twist (rad) at which the law has no torque.
    pub unloaded: f64,
    /// Friction.
    pub elements: Vec<SlipElement>,
}

impl Spring {
    /// A spring of one stiffness behind a play of `gap` to each side.
    #[must_use]
    pub fn with_gap(from: usize, to: Option<usize>, stiffness: f64, gap: f64) -> Self {
        let (knees, slopes) = if gap > 0.0 {
            (vec![-gap, gap], vec![stiffness, 0.0, stiffness])
        } else {
            (Vec::new(), vec![stiffness])
        };
        Self {
            from,
            to,
            knees,
            slopes,
            unloaded: 0.0,
            elements: Vec::new(),
        }
    }

    /// Number of the line on which the law is at this twist.
    #[must_use]
    pub fn line_at(&self, twist: f64) -> usize {
        self.knees.partition_point(|&knee| knee < twist)
    }

    /// Torque of the law where the line would meet twist zero, and its slope.
    #[must_use]
    pub fn line(&self, number: usize) -> (f64, f64) {
        let slope = self.slopes[number];
        // From the line without torque to this one, knee by knee.
        let home = self.line_at(self.unloaded);
        let mut offset = -self.slopes[home] * self.unloaded;
        let mut last = self.slopes[home];
        let mut pass = |knee: f64, next: f64| {
            offset += (last - next) * knee;
            last = next;
        };
        if number > home {
            for k in home..number {
                pass(self.knees[k], self.slopes[k + 1]);
            }
        } else {
            for k in (number..home).rev() {
                pass(self.knees[k], self.slopes[k]);
            }
        }
        (offset, slope)
    }

    /// Elastic torque at a twist.
    #[must_use]
    pub fn torque(&self, twist: f64) -> f64 {
        let (offset, slope) = self.line(self.line_at(twist));
        offset + slope * twist
    }

    /// Energy (J) in the law between its unloaded twist and this one.
    #[must_use]
    pub fn energy(&self, twist: f64) -> f64 {
        let work = |line: usize, from: f64, to: f64| {
            let (offset, slope) = self.line(line);
            (offset + 0.5 * slope * (from + to)) * (to - from)
        };
        let (start, end) = (self.line_at(self.unloaded), self.line_at(twist));
        let mut total = 0.0;
        let mut from = self.unloaded;
        if end >= start {
            for k in start..end {
                total += work(k, from, self.knees[k]);
                from = self.knees[k];
            }
        } else {
            for k in (end..start).rev() {
                total += work(k + 1, from, self.knees[k]);
                from = self.knees[k];
            }
        }
        total + work(end, from, twist)
    }

    /// Whether the motion of this spring can change branch.
    pub(super) fn has_events(&self) -> bool {
        !self.knees.is_empty() || !self.elements.is_empty()
    }

    fn check(&self, number: usize, nodes: usize) -> Result<(), TrainError> {
        let ends = self.from < nodes && self.to.is_none_or(|to| to < nodes && to != self.from);
        if !ends {
            return Err(TrainError::Ends { number });
        }
        if self.slopes.len() != self.knees.len() + 1 {
            return Err(TrainError::Length {
                what: "slopes of a spring's law",
                found: self.slopes.len(),
                expected: self.knees.len() + 1,
            });
        }
        let bad = |what, found, expected| TrainError::Number {
            what,
            number,
            found,
            expected,
        };
        for &slope in &self.slopes {
            if !(slope.is_finite() && slope >= 0.0) {
                return Err(bad("stiffness of spring", slope, "a number not below zero"));
            }
        }
        let numbers = self.knees.iter().chain([&self.unloaded]);
        if let Some(&twist) = numbers.into_iter().find(|twist| !twist.is_finite()) {
            return Err(bad("twist of spring", twist, "a finite number"));
        }
        if let Some(pair) = self.knees.windows(2).find(|pair| pair[0] >= pair[1]) {
            return Err(bad("twist of spring", pair[1], "twists that rise"));
        }
        for element in &self.elements {
            if !(element.stiffness.is_finite() && element.stiffness > 0.0) {
                let expected = "a number above zero";
                return Err(bad("slip stiffness of spring", element.stiffness, expected));
            }
            if !(element.limit.is_finite() && element.limit >= 0.0) {
                let expected = "a number not below zero";
                return Err(bad("friction limit of spring", element.limit, expected));
            }
            if !(0.0..1.0).contains(&element.load_factor) {
                let expected = "at least zero and below one";
                return Err(bad("load factor of spring", element.load_factor, expected));
            }
        }
        Ok(())
    }
}

/// Inertias joined by springs.
#[derive(Debug, Clone, PartialEq)]
pub struct Train {
    inertias: Vec<f64>,
    springs: Vec<Spring>,
    damping_s: f64,
}

impl Train {
    /// A train of these inertias (kg m^2) and springs.
    ///
    /// `damping_s` is the stiffness-proportional damping (s): beside every line of stiffness `k`
    /// acts a dashpot `k damping_s`.
    ///
    /// # Errors
    /// [`TrainError`] for an inertia that is not above zero, a spring that joins nothing, a law
    /// that falls, or numbers that are none.
    pub fn new(
        inertias: Vec<f64>,
        mut springs: Vec<Spring>,
        damping_s: f64,
    ) -> Result<Self, TrainError> {
        for (k, &inertia) in inertias.iter().enumerate() {
            if !(inertia.is_finite() && inertia > 0.0) {
                return Err(TrainError::Number {
                    what: "inertia",
                    number: k + 1,
                    found: inertia,
                    expected: "a number above zero",
                });
            }
        }
        if inertias.is_empty() {
            return Err(TrainError::Length {
                what: "inertias",
                found: 0,
                expected: 1,
            });
        }
        if !(damping_s.is_finite() && damping_s >= 0.0) {
            return Err(TrainError::Number {
                what: "damping",
                number: 1,
                found: damping_s,
                expected: "a number not below zero",
            });
        }
        for (k, spring) in springs.iter_mut().enumerate() {
            spring.check(k + 1, inertias.len())?;
            split_where_unloaded(spring);
        }
        Ok(Self {
            inertias,
            springs,
            damping_s,
        })
    }

    /// Inertias (kg m^2).
    #[must_use]
    pub fn inertias(&self) -> &[f64] {
        &self.inertias
    }

    /// Springs.
    #[must_use]
    pub fn springs(&self) -> &[Spring] {
        &self.springs
    }

    /// Stiffness-proportional damping (s).
    #[must_use]
    pub const fn damping_s(&self) -> f64 {
        self.damping_s
    }

    /// Twists (rad) of the springs at these angles (rad), and likewise for speeds.
    #[must_use]
    pub fn twists(&self, angles: &[f64]) -> Vec<f64> {
        let twist = |s: &Spring| angles[s.from] - s.to.map_or(0.0, |to| angles[to]);
        self.springs.iter().map(twist).collect()
    }
}

/// A limit that follows the load needs to know the sign of the load on each line of the law.
fn split_where_unloaded(spring: &mut Spring) {
    let follows = spring.elements.iter().any(|e| e.load_factor > 0.0);
    let home = spring.line_at(spring.unloaded);
    if follows && spring.slopes[home] > 0.0 && !spring.knees.contains(&spring.unloaded) {
        spring.knees.insert(home, spring.unloaded);
        spring.slopes.insert(home, spring.slopes[home]);
    }
}
