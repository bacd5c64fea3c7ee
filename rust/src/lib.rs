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
//! $$\mathbf c_j = e \mathbf u(\theta) + R_{OP} \mathbf u(\varphi_j - \theta/i).$$
//! It lies inside the pins' pitch circle while $\cos\psi_j < -e/(2R_{OP})$ with
//! $\psi_j = \theta(1 + 1/i) - \varphi_j$: a window of half width $\pi/2 - \delta$,
//! $\delta = \arcsin(e/2R_{OP})$ ([`model::hypotrochoid`], [`model::active_pins`]). The mean number
//! of active contacts gives the torque transfer efficiency and the torque of one pin (Eqs. 1-3)
//! $$\eta_{OP} = \frac{\bar n}{n_d N_{OP}/2}, \qquad T_O^{\ast} = \frac{T_O}{\bar n}.$$
//! The pins are cantilevers after Timoshenko with a deflection $\delta_p$ under a force $F$
//! (Eqs. 8-10, [`model::pin`]): $$C_{OP} = \frac{\delta_p}{F R_{OP}^2}.$$
//! The shaft's segments are in series (Eqs. 4-7, [`model::shaft`]), the pins in parallel
//! (Eqs. 11-13, [`model::compliance`]):
//! $$C_{OS} = C_{OS}^t + C_{OP}/N_{OP}, \qquad C_{OS}^{\ast} = i^2 C_{OS}, \qquad
//!   \theta' = \eta_{OP} C_{OS}^{\ast} n T_N \frac{180}{\pi} + \gamma.$$
//!
//! # Assumptions and validity
//!
//! Discs, flange, bearings, ring pins and all contacts are rigid; the loading line is straight
//! beyond the free play; friction, hysteresis and memory are not in the model (operators for them
//! are in [`model::hysteresis`]). The contacts, clearances and bearings that it leaves out are those
//! of [`components`], a model of its own. `statics` shares loads among equal springs on a rigid disc and is
//! valid for one or two discs. Ratios 3 to 300, 3 to 64 pins, 1 to 4 discs.
//!
//! # How to use it
//!
//! A [`model::design::Design`] has every input by name. A [`Study`] varies it over a
//! [`sampling::Space`] and gives columns of results; a variant that cannot be built keeps its row,
//! with a status.
//!
//! ```
//! use cyclosweep::model::active_pins::Criterion;
//! use cyclosweep::model::design::{Design, ShaftSegment};
//! use cyclosweep::model::inputs::Input;
//! use cyclosweep::sampling::{Axis, Layout, Rows, Space, Values};
//! use cyclosweep::{Output, Study, check};
//!
//! let design = Design {
//!     ratio: 87.0,
//!     disc_count: 2.0,
//!     eccentricity_mm: 0.62,
//!     ring_pin_circle_radius_mm: 75.0,
//!     hole_clocking_deg: -1.2,
//!     output_pin_count: 8.0,
//!     output_pin_circle_radius_mm: 45.0,
//!     output_pin_diameter_mm: 16.0,
//!     output_pin_bore_mm: 0.0,
//!     output_pin_length_mm: 40.0,
//!     bush_wall_mm: 2.0,
//!     disc_outer_radius_mm: 70.0,
//!     disc_bore_radius_mm: 25.0,
//!     youngs_modulus_gpa: 206.0,
//!     poisson_ratio: 0.3,
//!     keyway_coefficient: 10.0,
//!     input_power_kw: 1.14,
//!     input_speed_rpm: 1500.0,
//!     output_torque_nm: 585.0,
//!     free_play_deg: 28.0,
//!     input_inertia_kg_m2: None,
//!     output_stiffness_nm_per_arcmin: None,
//!     criterion: Criterion::PublishedMap,
//!     shaft: vec![ShaftSegment::Cylinder { diameter_mm: 50.0, length_mm: 120.0 }],
//! };
//! check(&design)?;
//!
//! let values = Values::Linspace { from: 0.4, to: 0.9, steps: 6 };
//! let axis = Axis { input: Input::Eccentricity as usize, values };
//! let space = Space::new(vec![axis], Layout::Grid, 0, 0)?;
//! let study = Study::new(space, &design, vec![1.0, 4.0], Vec::new())?;
//! let columns = study.evaluate(Rows::From(0), 6, &[Output::PinForceMax, Output::Twist(0)])?;
//! assert_eq!(columns.values[0][0], 4.0 * 585.0 / (2.0 * 8.0 * 0.045));
//! assert!(columns.values[1][5].is_nan(), "0.9 mm is too much for the ring");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # How a sweep runs
//!
//! A space gives every variant its inputs from its index alone. The kernel cuts the model into stages
//! by the inputs that each part needs. It computes a stage once where its inputs do not vary, once
//! per combination on a grid and per variant elsewhere, in blocks on all cores. The formulas of a
//! stage are written once, without branches. For a block of variants they become vector
//! instructions; the few variants of a block for which a condition fails are computed again alone,
//! with the reason where they are refused. Bits depend neither on the number of threads, nor on how
//! a study is cut, nor on the machine's instructions.

#![doc = include_str!("../katex-header.html")]

pub mod components;
pub mod dynamics;
mod kernel;
pub mod model;
#[cfg(feature = "python")]
mod py;
pub mod sampling;
mod wide;

pub use kernel::{Columns, Kind, Limit, Limited, Output, Source, Study, StudyError, Target, check};
