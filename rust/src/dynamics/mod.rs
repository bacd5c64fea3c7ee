//! Torsional dynamics of a train of inertias joined by springs with play and friction.
//!
//! Nodes carry inertias $J_j$, springs join two nodes or a node and the ground. With the twists
//! $x = B \theta$ of the springs and their torques $T(x)$ the train obeys
//! $$J \ddot\theta = \tau(t) - B^T T(x).$$
//! The law of a spring is a chain of straight lines (play is a line of slope zero), its friction a
//! sum of slip elements (springs that slide at a limit, Maxwell-slip or Jenkins elements). On a
//! *branch* (which line each spring is on, which elements slide which way) everything is linear:
//! the motion is that of the modes of this branch in closed form, under torques that
//! change linearly in time. [`transient`] follows it from event to event (a knee of a law, a
//! contact that closes, an element that starts or stops sliding), each located by isolation with
//! the bound of the acceleration and a safeguarded Newton step.
//!
//! Sources of the equations: W. T. Thomson, *Theory of Vibration with Applications* (modes of
//! torsional trains); the slip elements are those of [`crate::model::hysteresis`].

pub mod batch;
pub mod branch;
pub mod modes;
mod motion;
pub mod peaks;
pub mod train;
pub mod transient;

#[cfg(test)]
mod tests;
