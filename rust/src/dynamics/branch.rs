//! On which line every spring is, which of its slip elements slide, and what ends that.

use crate::dynamics::train::{SlipElement, Spring, Train};

/// Twist (rad, or part of it) by which an element that has stopped is short of sliding again, so
/// that rounding does not make it slide on the spot.
const SLACK: f64 = 1e-14;

/// Whether a slip element holds or slides.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Slip {
    /// It holds: a spring from this twist (rad) on.
    Holds(f64),
    /// It slides in this sense, +1 or -1.
    Slides(f64),
}

/// State of one spring.
#[derive(Debug, Clone, PartialEq)]
pub struct SpringState {
    /// Number of the line of its law.
    pub line: usize,
    /// State of its slip elements.
    pub slips: Vec<Slip>,
}

/// What ends a branch.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Cause {
    /// The law's next line begins, at a greater (true) or lower twist.
    Knee(bool),
    /// A slip element begins to slide, with growing (true) or falling twist.
    Slide(usize, bool),
    /// The twist stands still, so that what slid holds.
    Stop,
}

/// What an event was, as a table of events names it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum EventKind {
    /// The play is used up: the spring takes load.
    Contact,
    /// The spring lets go.
    Separation,
    /// The law goes on with another stiffness.
    Knee,
    /// Friction begins to slide.
    Slide,
    /// Friction holds again.
    Stick,
}

impl EventKind {
    /// The words of the column `event`, in the order of the kinds.
    pub const LABELS: [&str; 5] = ["contact", "separation", "knee", "slide", "stick"];
}

/// Twists between which a spring stays on its branch.
#[derive(Debug, Clone, Copy)]
pub(super) struct Range {
    /// Least twist and what happens there.
    pub(super) low: (f64, Cause),
    /// Greatest twist and what happens there.
    pub(super) high: (f64, Cause),
    /// Whether friction slides, which ends where the twist stands still.
    pub(super) slides: bool,
}

impl SpringState {
    /// State of a spring at a twist, with its slip elements anchored at these twists.
    #[must_use]
    pub fn at(spring: &Spring, twist: f64, anchors: &[f64]) -> Self {
        Self {
            line: spring.line_at(twist),
            slips: anchors.iter().map(|&anchor| Slip::Holds(anchor)).collect(),
        }
    }

    /// Torque of the spring as a straight line of its twist: value at twist zero, and slope.
    #[must_use]
    pub fn linear(&self, spring: &Spring) -> (f64, f64) {
        let law = spring.line(self.line);
        let (mut offset, mut slope) = law;
        let side = side_of(spring, self.line);
        for (element, slip) in spring.elements.iter().zip(&self.slips) {
            match *slip {
                Slip::Holds(anchor) => {
                    offset -= element.stiffness * anchor;
                    slope += element.stiffness;
                }
                Slip::Slides(sign) => {
                    let (constant, growth) = limit_line(element, law, side);
                    offset += sign * constant;
                    slope += sign * growth;
                }
            }
        }
        (offset, slope)
    }

    /// Friction torque at a twist.
    #[must_use]
    pub fn friction(&self, spring: &Spring, twist: f64) -> f64 {
        let (offset, slope) = self.linear(spring);
        let law = spring.line(self.line);
        offset - law.0 + (slope - law.1) * twist
    }

    /// Energy (J) that the elements which hold have stored, those that slide included.
    #[must_use]
    pub fn slip_energy(&self, spring: &Spring, twist: f64) -> f64 {
        let law = spring.line(self.line);
        let side = side_of(spring, self.line);
        let stored = |(element, slip): (&SlipElement, &Slip)| {
            let torque = match *slip {
                Slip::Holds(anchor) => element.stiffness * (twist - anchor),
                Slip::Slides(_) => {
                    let (constant, growth) = limit_line(element, law, side);
                    constant + growth * twist
                }
            };
            0.5 * torque * torque / element.stiffness
        };
        spring.elements.iter().zip(&self.slips).map(stored).sum()
    }

    /// Energy (J) that sliding takes along a stretch of this branch.
    #[must_use]
    pub fn lost(&self, spring: &Spring, from: f64, to: f64) -> f64 {
        let law = spring.line(self.line);
        let side = side_of(spring, self.line);
        let lost = |(element, slip): (&SlipElement, &Slip)| match *slip {
            Slip::Holds(_) => 0.0,
            Slip::Slides(sign) => {
                let (constant, growth) = limit_line(element, law, side);
                let middle = constant + 0.5 * growth * (from + to);
                // A limit that follows the load also stretches the element.
                let stored = middle * growth * (to - from) / element.stiffness;
                sign * middle * (to - from) - stored
            }
        };
        spring.elements.iter().zip(&self.slips).map(lost).sum()
    }

    /// Twists between which the branch holds.
    pub(super) fn range(&self, spring: &Spring) -> Range {
        let knee = |k: Option<usize>| k.and_then(|k| spring.knees.get(k)).copied();
        let mut low = (
            knee(self.line.checked_sub(1)).unwrap_or(f64::NEG_INFINITY),
            Cause::Knee(false),
        );
        let mut high = (
            knee(Some(self.line)).unwrap_or(f64::INFINITY),
            Cause::Knee(true),
        );
        let law = spring.line(self.line);
        let side = side_of(spring, self.line);
        let mut slides = false;
        for (k, (element, slip)) in spring.elements.iter().zip(&self.slips).enumerate() {
            let Slip::Holds(anchor) = *slip else {
                slides = true;
                continue;
            };
            let (constant, growth) = limit_line(element, law, side);
            let stiffness = element.stiffness;
            let meets = |sign: f64| {
                let closing = stiffness - sign * growth;
                let at = (sign * constant + stiffness * anchor) / closing;
                if closing > 0.0 {
                    at
                } else {
                    sign * f64::INFINITY
                }
            };
            if meets(1.0) < high.0 {
                high = (meets(1.0), Cause::Slide(k, true));
            }
            if meets(-1.0) > low.0 {
                low = (meets(-1.0), Cause::Slide(k, false));
            }
        }
        Range { low, high, slides }
    }

    /// Goes on to the next branch.
    pub(super) fn pass(&mut self, spring: &Spring, cause: Cause, twist: f64) -> EventKind {
        match cause {
            Cause::Knee(up) => {
                let before = spring.slopes[self.line];
                self.line = if up { self.line + 1 } else { self.line - 1 };
                let now = spring.slopes[self.line];
                if before == 0.0 && now > 0.0 {
                    EventKind::Contact
                } else if before > 0.0 && now == 0.0 {
                    EventKind::Separation
                } else {
                    EventKind::Knee
                }
            }
            Cause::Slide(k, up) => {
                self.slips[k] = Slip::Slides(if up { 1.0 } else { -1.0 });
                EventKind::Slide
            }
            Cause::Stop => {
                let law = spring.line(self.line);
                let side = side_of(spring, self.line);
                for (element, slip) in spring.elements.iter().zip(&mut self.slips) {
                    if let Slip::Slides(sign) = *slip {
                        let (constant, growth) = limit_line(element, law, side);
                        let torque = sign * (constant + growth * twist);
                        let slack = sign * SLACK * (1.0 + twist.abs());
                        *slip = Slip::Holds(twist - torque / element.stiffness + slack);
                    }
                }
                EventKind::Stick
            }
        }
    }
}

/// Sign of the elastic torque on a line of the law; zero where it has none.
fn side_of(spring: &Spring, line: usize) -> f64 {
    let home = spring.line_at(spring.unloaded);
    match line.cmp(&home) {
        std::cmp::Ordering::Greater => 1.0,
        std::cmp::Ordering::Less => -1.0,
        // A law whose limit follows the load ends its line where it has no torque.
        std::cmp::Ordering::Equal if spring.slopes[home] > 0.0 => -1.0,
        std::cmp::Ordering::Equal => 0.0,
    }
}

/// Limit of a slip element as a straight line of the twist: value at twist zero, and slope.
fn limit_line(element: &SlipElement, law: (f64, f64), side: f64) -> (f64, f64) {
    let factor = element.load_factor * side;
    (element.limit + factor * law.0, factor * law.1)
}

/// Twist of a spring under a torque that has grown from zero, and the anchors of its elements.
#[must_use]
pub fn static_twist(spring: &Spring, torque: f64) -> (f64, Vec<f64>) {
    let home = spring.unloaded;
    let friction = |element: &SlipElement, twist: f64| {
        let limit = element.limit + element.load_factor * spring.torque(twist).abs();
        (element.stiffness * (twist - home)).clamp(-limit, limit)
    };
    let total = |twist: f64| {
        let held = spring.elements.iter().map(|e| friction(e, twist));
        spring.torque(twist) + held.sum::<f64>()
    };
    let anchors = |twist: f64| {
        let anchor = |e: &SlipElement| twist - friction(e, twist) / e.stiffness;
        spring.elements.iter().map(anchor).collect()
    };
    if torque == 0.0 {
        return (home, anchors(home));
    }
    let sign = torque.signum();
    let far = |twist: f64| sign * (total(twist) - torque) < 0.0;
    let mut reach = 1e-6;
    while far(home + sign * reach) && reach < 1e9 {
        reach *= 2.0;
    }
    // Halving down to the last bit: the slope jumps at every knee and limit.
    let (mut near, mut end) = (home, home + sign * reach);
    loop {
        let middle = 0.5 * (near + end);
        if middle == near || middle == end {
            return (end, anchors(end));
        }
        if far(middle) {
            near = middle;
        } else {
            end = middle;
        }
    }
}

/// State of all springs at their twists, friction relaxed or held at the given anchors.
pub(super) fn states(train: &Train, twists: &[f64], anchors: &[Vec<f64>]) -> Vec<SpringState> {
    let springs = train.springs().iter().zip(twists).zip(anchors);
    springs
        .map(|((spring, &twist), anchors)| SpringState::at(spring, twist, anchors))
        .collect()
}
