//! Compliance of single-stage cycloidal drives, in closed form, for many variants at once.
//!
//! The model is that of Kumar, Kosse and Oloyede, *A new method to estimate effective elastic
//! torsional compliance of single-stage Cycloidal drives*, Mechanism and Machine Theory 105 (2016)
//! 185-198, [doi](https://doi.org/10.1016/j.mechmachtheory.2016.06.023).
//!
//! # The model
//!
//! With $\theta$ the position of the mesh zone, $\mathbf u$ the unit vector and $\varphi_j$ the
//! place of hole $j$ at $\theta = 0$, the centre of an oversized hole traces the hypotrochoid
//! $$\mathbf c_j = e\,\mathbf u(\theta) + R_{OP}\,\mathbf u(\varphi_j - \theta/i).$$
//! It lies inside the pins' pitch circle while $\cos\psi_j < -e/(2R_{OP})$ with
//! $\psi_j = \theta(1 + 1/i) - \varphi_j$: a window of half width $\pi/2 - \delta$,
//! $\delta = \arcsin(e/2R_{OP})$ ([`hypotrochoid`], [`active_pins`]). The mean number of active
//! contacts gives the torque transfer efficiency (Eqs. 1-3)
//! $$\eta_{OP} = \frac{\bar n}{n_d N_{OP}/2}.$$
//! The shaft's segments are in series (Eqs. 4-7, [`shaft`]), the pins, cantilevers after
//! Timoshenko (Eqs. 8-10, [`pin`]), in parallel (Eqs. 11-13, [`compliance`]):
//! $$C_{OS} = C^t_{OS} + C_{OP}/N_{OP},\qquad C^*_{OS} = i^2 C_{OS},\qquad
//!   \theta' = \eta_{OP}\,C^*_{OS}\,n T_N\,\frac{180}{\pi} + \gamma.$$
//!
//! # Assumptions and validity
//!
//! Discs, flange, bearings, ring pins and all contacts are rigid; the loading line is straight
//! beyond the free play; friction, hysteresis and memory are not in the model. `statics` shares
//! loads among equal springs on a rigid disc and is valid for one or two discs. Ratios 3 to 300,
//! 3 to 64 pins, 1 to 4 discs.
//!
//! # How a sweep runs
//!
//! A [`space::Space`] gives every variant its inputs from its index alone. [`stages`] cut the
//! model by the inputs each part needs; [`columns::Study`] computes a stage once where its inputs
//! do not vary, once per combination on a grid, per variant elsewhere, in blocks on all cores.
//! A stage's formulas are written once, without branches, before a [`judge`] of their conditions:
//! over a block's [`lanes`] they become the machine's vector instructions, and the few variants that
//! a block cannot settle are computed alone, with the reason where they are refused. Bits depend
//! neither on the number of threads, nor on how a study is cut, nor on the machine's instructions.

pub mod active_pins;
mod arrangement;
mod blocks;
pub mod columns;
pub mod compliance;
mod elementary;
pub mod error;
pub mod hypotrochoid;
pub mod hysteresis;
pub mod inputs;
mod joe_kuo;
pub mod judge;
mod known;
pub mod lanes;
pub mod map_stage;
pub mod outputs;
pub mod pin;
pub mod pin_force;
mod published_map;
mod rounding;
pub mod sampling;
pub mod shaft;
pub mod shaft_plan;
pub mod space;
pub mod stages;

#[cfg(feature = "python")]
mod py;
