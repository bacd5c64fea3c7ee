//! The widest instructions that the machine has.
//!
//! What runs here is compiled twice, for every machine and for those with AVX2. Neither fuses a
//! product with a sum, so that the bits are the same.

use pulp::{Arch, Simd, WithSimd};

/// Work to run with the widest instructions there are. Its `run` and all it calls must be
/// `inline(always)`.
pub(crate) trait Wide {
    /// What comes of it.
    type Output;
    /// Does the work.
    fn run(self) -> Self::Output;
}

/// Runs `work` with the widest instructions that this machine has.
#[inline]
pub(crate) fn with_widest<W: Wide>(work: W) -> W::Output {
    struct Dispatched<W>(W);
    impl<W: Wide> WithSimd for Dispatched<W> {
        type Output = W::Output;
        #[inline(always)]
        fn with_simd<S: Simd>(self, _: S) -> W::Output {
            self.0.run()
        }
    }
    Arch::new().dispatch(Dispatched(work))
}
