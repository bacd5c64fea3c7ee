//! The component model: load sharing among ring pins, output pins and bearings of elastic contacts.
//!
//! What the published model leaves rigid is elastic here: the contacts of disc and ring pins, of
//! holes and output pins, the pins and their roots, and the eccentric's bearings. Discs, flange,
//! ring and eccentric stay rigid between their contacts. The equilibrium is the least of a convex
//! energy of `1 + 3 n` unknowns for `n` discs ([`equilibrium`]).

mod block;
pub mod contact;
pub mod curve;
pub mod details;
pub mod equilibrium;
mod forces;
#[cfg(test)]
mod golden;
pub mod inputs;
pub mod laws;
pub mod mechanism;
pub mod outputs;
pub mod parts;
pub mod pin_root;
pub mod pins;
mod positions;
pub mod profile;
pub mod quadratic;
pub mod ring;
pub mod sharing;
pub mod study;
pub mod turn;
