//! Contacts of one disc at several positions of the crank, one position a lane: where they are, and
//! the sums over them that an equilibrium needs.

use pulp::Simd;

use crate::components::mechanism::{Circle, Mechanism};
use crate::components::positions::laws::{Depths, LEAST_DEPTH, Laws};
use crate::components::positions::vector::{Column, Vector};

/// A loaded ring contact in every lane; force zero where it is not loaded.
#[derive(Debug, Clone, Copy)]
pub(crate) struct RingContacts<S: Simd> {
    pub force: Vector<S>,
    pub depth: Vector<S>,
    pub gap: Vector<S>,
    pub normal: [Vector<S>; 2],
    /// Distance from the pin's centre to the pitch point over R.
    pub length: Vector<S>,
    /// Number of the pin, counted on without end.
    pub pin: Vector<S>,
}

/// A loaded output contact in every lane; force zero where it is not loaded.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PinContacts<S: Simd> {
    pub force: Vector<S>,
    pub depth: Vector<S>,
    pub gap: Vector<S>,
    /// Direction of the line of centres.
    pub line: [Vector<S>; 2],
    /// Share of the force along and across the motion of the hole under a rotation.
    pub along: Vector<S>,
    pub across: Vector<S>,
    /// Number of the pin.
    pub pin: usize,
}

/// What looks at the loaded contacts while they are summed.
pub(crate) trait Visit<S: Simd> {
    /// A ring contact of a disc.
    fn ring(&mut self, disc: usize, contacts: &RingContacts<S>);
    /// An output contact of a disc.
    fn pin(&mut self, disc: usize, contacts: &PinContacts<S>);
}

/// Nobody.
pub(crate) struct Nobody;

impl<S: Simd> Visit<S> for Nobody {
    #[inline(always)]
    fn ring(&mut self, _: usize, _: &RingContacts<S>) {}
    #[inline(always)]
    fn pin(&mut self, _: usize, _: &PinContacts<S>) {}
}

/// Ring contacts of a disc, beginning in every lane at the pin next to the eccentricity's
/// direction.
#[derive(Debug, Clone, Default)]
pub(crate) struct Ring {
    normal_x: Column,
    normal_y: Column,
    length: Column,
    /// Number of the first pin in every lane.
    first: Column,
    /// Only where gaps differ.
    gap: Column,
    uniform: f64,
    differ: bool,
}

/// Gradient and second derivatives xx, xy, yy of a ring's energy.
#[derive(Debug, Clone, Copy)]
pub(crate) struct RingSums<S: Simd> {
    pub gradient: [Vector<S>; 2],
    pub hessian: [Vector<S>; 3],
}

impl Ring {
    /// The contacts of a disc at `angles` (rad), a lane each.
    #[inline(always)]
    pub(crate) fn set<S: Simd>(
        &mut self,
        simd: S,
        mechanism: &Mechanism,
        circle: &Circle,
        angles: &[f64],
    ) {
        let pins = mechanism.ring_pins();
        let lanes = Vector::<S>::LANES;
        let pitch = std::f64::consts::TAU / pins as f64;
        let shift = |lane: usize| (angles[lane] / pitch).floor();
        let rest = Vector::of(simd, |lane| angles[lane] - shift(lane) * pitch);
        let (sin, cos) = rest.sin_cos();
        self.first.make_room(lanes);
        for (lane, first) in self.first.get_mut().iter_mut().enumerate() {
            *first = shift(lane);
        }
        for column in [&mut self.normal_x, &mut self.normal_y, &mut self.length] {
            column.make_room(pins * lanes);
        }
        let width = mechanism.eccentricity * pins as f64 / mechanism.ring_radius;
        let one = Vector::splat(simd, 1.0);
        let normals = Vector::<S>::of_slice_mut(self.normal_x.get_mut()).iter_mut();
        let normals = normals.zip(Vector::<S>::of_slice_mut(self.normal_y.get_mut()));
        let rows = normals.zip(Vector::<S>::of_slice_mut(self.length.get_mut()));
        let places = circle.cos.iter().zip(&circle.sin);
        for (((x, y), length), (c, s)) in rows.zip(places) {
            // From pin to pitch point over R.
            let along = -(cos * *c + sin * *s) + width;
            let across = sin * *c - cos * *s;
            let distance = (along * along + across * across).sqrt();
            let inverse = one / distance;
            *x = (along * inverse).raw();
            *y = (across * inverse).raw();
            *length = distance.raw();
        }
        self.uniform = mechanism.ring_gap;
        let enlargement = mechanism.ring_enlargement;
        let turned = mechanism.profile_rotation.abs() * mechanism.ring_lever();
        let errors = &mechanism.ring_gap_errors;
        self.differ = enlargement != 0.0 || turned != 0.0 || !errors.is_empty();
        if !self.differ {
            return;
        }
        self.gap.make_room(pins * lanes);
        let normals = Vector::<S>::of_slice(self.normal_y.get()).iter();
        let lengths = normals.zip(Vector::<S>::of_slice(self.length.get()));
        let gaps = Vector::<S>::of_slice_mut(self.gap.get_mut()).iter_mut();
        for (gap, (y, length)) in gaps.zip(lengths) {
            let (y, length) = (Vector::new(simd, *y), Vector::new(simd, *length));
            // With a = cosine, length^2 = 1 + width^2 - 2 width a, outward = (1 - width a) / length.
            let outward = (length + (one - one * (width * width)) / length) * 0.5;
            *gap = (outward * enlargement + y.abs() * turned + self.uniform).raw();
        }
        if !errors.is_empty() {
            let gaps = self.gap.get_mut();
            for (row, gaps) in gaps.chunks_exact_mut(lanes).enumerate() {
                for (lane, gap) in gaps.iter_mut().enumerate() {
                    let pin = (row as i64 + shift(lane) as i64).rem_euclid(pins as i64);
                    *gap += errors[pin as usize];
                }
            }
        }
    }

    /// Normals and gaps of every contact.
    #[inline(always)]
    pub(crate) fn rows<S: Simd>(
        &self,
        simd: S,
    ) -> impl Iterator<Item = ([Vector<S>; 2], Vector<S>)> + '_ {
        let x = Vector::<S>::of_slice(self.normal_x.get());
        let y = Vector::<S>::of_slice(self.normal_y.get());
        let gap = Vector::<S>::of_slice(self.gap.get());
        let uniform = Vector::splat(simd, self.uniform);
        x.iter().zip(y).enumerate().map(move |(row, (x, y))| {
            let gap = if self.differ {
                Vector::new(simd, gap[row])
            } else {
                uniform
            };
            ([Vector::new(simd, *x), Vector::new(simd, *y)], gap)
        })
    }

    /// Whether all gaps are alike.
    pub(crate) const fn is_uniform(&self) -> bool {
        !self.differ
    }

    /// Sums over the contacts under a shift (m) of the pitch point along u and v.
    #[inline(always)]
    pub(crate) fn sums<S: Simd, L: Laws<S>>(
        &self,
        simd: S,
        laws: &mut L,
        disc: usize,
        shift: [Vector<S>; 2],
        visit: &mut impl Visit<S>,
    ) -> RingSums<S> {
        if self.differ {
            self.sums_of::<S, L, true>(simd, laws, disc, shift, visit)
        } else {
            self.sums_of::<S, L, false>(simd, laws, disc, shift, visit)
        }
    }

    #[inline(always)]
    fn sums_of<S: Simd, L: Laws<S>, const DIFFER: bool>(
        &self,
        simd: S,
        laws: &mut L,
        disc: usize,
        shift: [Vector<S>; 2],
        visit: &mut impl Visit<S>,
    ) -> RingSums<S> {
        let zero = Vector::zero(simd);
        let least = Vector::splat(simd, LEAST_DEPTH);
        let [mut fx, mut fy, mut xx, mut xy, mut yy] = [zero; 5];
        let mut depths = Depths::none(simd);
        let normals_x = Vector::<S>::of_slice(self.normal_x.get());
        let normals_y = &Vector::<S>::of_slice(self.normal_y.get())[..normals_x.len()];
        let lengths = &Vector::<S>::of_slice(self.length.get())[..normals_x.len()];
        let gaps = if DIFFER { self.gap.get() } else { &[] };
        let gaps = Vector::<S>::of_slice(gaps);
        let uniform = Vector::splat(simd, self.uniform);
        let first = Vector::new(simd, Vector::<S>::of_slice(self.first.get())[0]);
        for row in 0..normals_x.len() {
            let x = Vector::new(simd, normals_x[row]);
            let y = Vector::new(simd, normals_y[row]);
            let gap = if DIFFER {
                Vector::new(simd, gaps[row])
            } else {
                uniform
            };
            let depth = -(x * shift[0] + y * shift[1]) - gap;
            let touches = depth.above(least);
            if !touches.any() {
                continue;
            }
            let depth = depth.max(least);
            let (secant, growth) = laws.ring(depth);
            let force = touches.keep(secant * depth);
            let growth = touches.keep(growth);
            let (gx, gy) = (growth * x, growth * y);
            fx -= force * x;
            fy -= force * y;
            xx += gx * x;
            xy += gx * y;
            yy += gy * y;
            if L::FOLLOWS {
                depths.add(touches.keep(depth));
            }
            visit.ring(
                disc,
                &RingContacts {
                    force,
                    depth,
                    gap,
                    normal: [x, y],
                    length: Vector::new(simd, lengths[row]),
                    pin: first + row as f64,
                },
            );
        }
        let factor = laws.ring_factor(disc, &depths);
        RingSums {
            gradient: [fx * factor, fy * factor],
            hessian: [xx * factor, xy * factor, yy * factor],
        }
    }
}

/// Output contacts of a disc.
#[derive(Debug, Clone, Default)]
pub(crate) struct Pins {
    tangent_x: Column,
    tangent_y: Column,
    gap: Vec<f64>,
}

/// Gradient and second derivatives bb, bx, by, xx, xy, yy of the pins' energy.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PinSums<S: Simd> {
    pub gradient: [Vector<S>; 3],
    pub hessian: [Vector<S>; 6],
}

impl Pins {
    /// The contacts of a disc whose holes are turned back by `angles` (rad), a lane each.
    #[inline(always)]
    pub(crate) fn set<S: Simd>(
        &mut self,
        simd: S,
        mechanism: &Mechanism,
        circle: &Circle,
        angles: &[f64],
    ) {
        let count = mechanism.output_pins;
        let (sin, cos) = Vector::of(simd, |lane| angles[lane]).sin_cos();
        self.tangent_x.make_room(count * Vector::<S>::LANES);
        self.tangent_y.make_room(count * Vector::<S>::LANES);
        let x = Vector::<S>::of_slice_mut(self.tangent_x.get_mut()).iter_mut();
        let rows = x.zip(Vector::<S>::of_slice_mut(self.tangent_y.get_mut()));
        for ((x, y), (c, s)) in rows.zip(circle.cos.iter().zip(&circle.sin)) {
            *x = (sin * *c - cos * *s).raw();
            *y = (cos * *c + sin * *s).raw();
        }
        self.gap.clear();
        self.gap.resize(count, mechanism.hole_gap);
        for (gap, error) in self.gap.iter_mut().zip(&mechanism.hole_gap_errors) {
            *gap += error;
        }
    }

    /// Direction in which a rotation of the disc moves each hole, and its gap.
    #[inline(always)]
    pub(crate) fn rows<S: Simd>(
        &self,
        simd: S,
    ) -> impl Iterator<Item = ([Vector<S>; 2], f64)> + '_ {
        let x = Vector::<S>::of_slice(self.tangent_x.get());
        let y = Vector::<S>::of_slice(self.tangent_y.get());
        x.iter()
            .zip(y)
            .zip(&self.gap)
            .map(move |((x, y), gap)| ([Vector::new(simd, *x), Vector::new(simd, *y)], *gap))
    }

    /// The gap of every hole; none where they differ.
    pub(crate) fn even_gap(&self) -> Option<f64> {
        let first = *self.gap.first()?;
        self.gap.iter().all(|gap| *gap == first).then_some(first)
    }

    /// Sums over the contacts under a disc's motion against the flange: rotation times R_OP, x and
    /// y (m).
    #[inline(always)]
    pub(crate) fn sums<S: Simd, L: Laws<S>>(
        &self,
        simd: S,
        laws: &mut L,
        disc: usize,
        eccentricity: f64,
        motion: [Vector<S>; 3],
        visit: &mut impl Visit<S>,
    ) -> PinSums<S> {
        let zero = Vector::zero(simd);
        let one = Vector::splat(simd, 1.0);
        let least = Vector::splat(simd, LEAST_DEPTH);
        let mut gradient = [zero; 3];
        let mut hessian = [zero; 6];
        let mut depths = Depths::none(simd);
        let [turn, x, y] = motion;
        let apart = x + eccentricity;
        for (pin, ([tx, ty], gap)) in self.rows(simd).enumerate() {
            let (dx, dy) = (apart + turn * tx, y + turn * ty);
            let square = dx * dx + dy * dy;
            let reach = (eccentricity + gap).max(0.0);
            // The same in every lane whatever the others do: rounding of the root may make a depth
            // where there is none.
            let outside = square.above(Vector::splat(simd, reach * reach));
            if !outside.any() {
                continue;
            }
            let distance = square.sqrt();
            let inverse = one / distance;
            let (mx, my) = (dx * inverse, dy * inverse);
            let depth = distance - eccentricity - gap;
            let touches = outside.and(depth.above(least));
            let depth = depth.max(least);
            let (force, slope) = laws.pin(disc, depth);
            let force = touches.keep(force);
            let slope = touches.keep(slope);
            // Along the line of centres and across it, under (turn, x, y).
            let along = mx * tx + my * ty;
            let across = mx * ty - my * tx;
            let stiffening = force * inverse;
            gradient[0] += force * along;
            gradient[1] += force * mx;
            gradient[2] += force * my;
            let (by_along, by_across) = (slope * along, stiffening * across);
            hessian[0] += by_along * along + by_across * across;
            hessian[1] += by_along * mx - by_across * my;
            hessian[2] += by_along * my + by_across * mx;
            hessian[3] += slope * mx * mx + stiffening * my * my;
            hessian[4] += (slope - stiffening) * mx * my;
            hessian[5] += slope * my * my + stiffening * mx * mx;
            if L::FOLLOWS {
                depths.add(touches.keep(depth));
            }
            visit.pin(
                disc,
                &PinContacts {
                    force,
                    depth,
                    gap: Vector::splat(simd, gap),
                    line: [mx, my],
                    along,
                    across,
                    pin,
                },
            );
        }
        let factor = laws.pin_factor(disc, &depths);
        for sum in &mut gradient {
            *sum *= factor;
        }
        for sum in &mut hessian {
            *sum *= factor;
        }
        PinSums { gradient, hessian }
    }
}
