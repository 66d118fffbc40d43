//! Four numbers in single precision at a time, and the choice of the machine's instructions.
//!
//! Products and sums are fused ([`f32::mul_add`]) on every machine, in the same order, so that the
//! choice changes the time and not one bit: where the processor has no fused instruction the
//! standard library computes the same, slowly.
#![allow(unsafe_code)] // Instructions that not every processor has; the reasons are at each use.

use std::sync::atomic::{AtomicBool, Ordering};

/// Rows summed in single precision before they are added up in double.
pub(super) const LANE_ROWS: usize = 64;

/// The sum of four lanes in double precision.
#[inline(always)]
pub(super) fn in_double([x, y, z, w]: [f32; 4]) -> f64 {
    (f64::from(x) + f64::from(y)) + (f64::from(z) + f64::from(w))
}

/// Three numbers and a fourth that is zero, or four.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C, align(16))]
pub(crate) struct Four(pub(crate) [f32; 4]);

/// Arithmetic in registers.
pub(crate) trait Arithmetic: Copy {
    /// Four numbers in a register, or twice four.
    type F: Copy;
    /// The same number four times.
    fn splat(self, x: f32) -> Self::F;
    /// a + b.
    fn add(self, a: Self::F, b: Self::F) -> Self::F;
    /// a - b.
    fn sub(self, a: Self::F, b: Self::F) -> Self::F;
    /// a b.
    fn mul(self, a: Self::F, b: Self::F) -> Self::F;
    /// a b + c, rounded once.
    fn mul_add(self, a: Self::F, b: Self::F, c: Self::F) -> Self::F;
    /// c - a b, rounded once.
    fn sub_mul(self, a: Self::F, b: Self::F, c: Self::F) -> Self::F;
    /// (y, z, x, w).
    fn yzx(self, a: Self::F) -> Self::F;
    /// (z, x, y, w).
    fn zxy(self, a: Self::F) -> Self::F;
    /// The sum of all lanes, (x + y) + (z + w), four times.
    fn sum(self, a: Self::F) -> Self::F;
}

/// The operations that the kernels are made of, on four numbers.
pub(crate) trait Lanes: Arithmetic + Send + Sync {
    /// The same with twice four numbers.
    type Two: Arithmetic;
    /// The same with twice four numbers.
    fn two(self) -> Self::Two;
    /// Twice four numbers.
    fn pair(self, a: Self::F, b: Self::F) -> <Self::Two as Arithmetic>::F;
    /// `a` four times, then `b`.
    fn splats(self, a: f32, b: f32) -> <Self::Two as Arithmetic>::F;
    /// Twice four numbers apart.
    fn halves(self, a: <Self::Two as Arithmetic>::F) -> [Self::F; 2];
    /// From memory.
    fn load(self, from: &Four) -> Self::F;
    /// To memory.
    fn store(self, to: &mut Four, f: Self::F);
    /// Four numbers that are not together in memory yet.
    fn set(self, from: [f32; 4]) -> Self::F;
    /// a / b.
    fn div(self, a: Self::F, b: Self::F) -> Self::F;
    /// Lane `LANE` four times.
    fn lane<const LANE: usize>(self, a: Self::F) -> Self::F;
    /// Lanes where a >= b, as bits.
    fn at_least(self, a: Self::F, b: Self::F) -> u32;
    /// Rows to columns.
    fn transpose(self, rows: [Self::F; 4]) -> [Self::F; 4];
    /// The four numbers.
    fn array(self, a: Self::F) -> [f32; 4];
}

/// Work that is written once for all machines.
pub(crate) trait Kernel {
    /// What it gives.
    type Output;
    /// Does it; to be `#[inline(always)]`, so that it is compiled for the instructions in use.
    fn run<L: Lanes>(self, lanes: L) -> Self::Output;
}

/// Runs `kernel` with the best instructions that this machine has.
#[inline]
pub(crate) fn dispatch<K: Kernel>(kernel: K) -> K::Output {
    #[cfg(target_arch = "x86_64")]
    if let Some(fused) = x86::Fused::chosen() {
        // SAFETY: the value exists only where AVX2 and FMA do.
        return unsafe { x86::run(fused, kernel) };
    }
    kernel.run(Portable)
}

/// Name of the kernels of plain Rust, as the compiler makes them for any machine.
const PORTABLE: &str = "portable";

/// Name of the kernels for x86-64 with AVX2 and FMA.
const FUSED: &str = "avx2-fma";

/// Whether [`choose`] has asked for the portable kernels.
static PORTABLE_ASKED: AtomicBool = AtomicBool::new(false);

/// Name of the kernels in use: `avx2-fma` where the machine has these instructions, unless
/// [`choose`] says otherwise, or `portable`. Both give the same bits.
#[must_use]
pub fn kernels() -> &'static str {
    #[cfg(target_arch = "x86_64")]
    if x86::Fused::chosen().is_some() {
        return FUSED;
    }
    PORTABLE
}

/// From now on the kernels called `name` are used, in the whole process.
///
/// # Errors
/// When this machine or version has none of that name; those in use stay.
pub fn choose(name: &str) -> Result<(), String> {
    let portable = name == PORTABLE;
    #[cfg(target_arch = "x86_64")]
    let has = portable || (name == FUSED && x86::Fused::detect().is_some());
    #[cfg(not(target_arch = "x86_64"))]
    let has = portable;
    if !has {
        let in_use = kernels();
        return Err(format!("this machine has no kernels `{name}`; `{in_use}` give the same bits"));
    }
    PORTABLE_ASKED.store(portable, Ordering::Relaxed);
    Ok(())
}

/// Plain Rust.
#[derive(Clone, Copy)]
pub(super) struct Portable;

impl Arithmetic for Portable {
    type F = [f32; 4];

    #[inline(always)]
    fn splat(self, x: f32) -> Self::F {
        [x; 4]
    }

    #[inline(always)]
    fn add(self, a: Self::F, b: Self::F) -> Self::F {
        std::array::from_fn(|k| a[k] + b[k])
    }

    #[inline(always)]
    fn sub(self, a: Self::F, b: Self::F) -> Self::F {
        std::array::from_fn(|k| a[k] - b[k])
    }

    #[inline(always)]
    fn mul(self, a: Self::F, b: Self::F) -> Self::F {
        std::array::from_fn(|k| a[k] * b[k])
    }

    #[inline(always)]
    fn mul_add(self, a: Self::F, b: Self::F, c: Self::F) -> Self::F {
        std::array::from_fn(|k| a[k].mul_add(b[k], c[k]))
    }

    #[inline(always)]
    fn sub_mul(self, a: Self::F, b: Self::F, c: Self::F) -> Self::F {
        std::array::from_fn(|k| (-a[k]).mul_add(b[k], c[k]))
    }

    #[inline(always)]
    fn yzx(self, a: Self::F) -> Self::F {
        [a[1], a[2], a[0], a[3]]
    }

    #[inline(always)]
    fn zxy(self, a: Self::F) -> Self::F {
        [a[2], a[0], a[1], a[3]]
    }

    #[inline(always)]
    fn sum(self, a: Self::F) -> Self::F {
        [(a[0] + a[1]) + (a[2] + a[3]); 4]
    }
}

impl Lanes for Portable {
    type Two = PortableTwo;

    #[inline(always)]
    fn two(self) -> PortableTwo {
        PortableTwo
    }

    #[inline(always)]
    fn pair(self, a: [f32; 4], b: [f32; 4]) -> [[f32; 4]; 2] {
        [a, b]
    }

    #[inline(always)]
    fn splats(self, a: f32, b: f32) -> [[f32; 4]; 2] {
        [[a; 4], [b; 4]]
    }

    #[inline(always)]
    fn halves(self, a: [[f32; 4]; 2]) -> [[f32; 4]; 2] {
        a
    }

    #[inline(always)]
    fn load(self, from: &Four) -> Self::F {
        from.0
    }

    #[inline(always)]
    fn store(self, to: &mut Four, f: Self::F) {
        to.0 = f;
    }

    #[inline(always)]
    fn set(self, from: [f32; 4]) -> Self::F {
        from
    }

    #[inline(always)]
    fn div(self, a: Self::F, b: Self::F) -> Self::F {
        std::array::from_fn(|k| a[k] / b[k])
    }

    #[inline(always)]
    fn lane<const LANE: usize>(self, a: Self::F) -> Self::F {
        [a[LANE]; 4]
    }

    #[inline(always)]
    fn at_least(self, a: Self::F, b: Self::F) -> u32 {
        (0..4).map(|k| u32::from(a[k] >= b[k]) << k).sum()
    }

    #[inline(always)]
    fn transpose(self, rows: [Self::F; 4]) -> [Self::F; 4] {
        std::array::from_fn(|k| rows.map(|row| row[k]))
    }

    #[inline(always)]
    fn array(self, a: Self::F) -> [f32; 4] {
        a
    }
}

/// Plain Rust, twice.
#[derive(Clone, Copy)]
pub(super) struct PortableTwo;

impl Arithmetic for PortableTwo {
    type F = [[f32; 4]; 2];

    #[inline(always)]
    fn splat(self, x: f32) -> Self::F {
        [[x; 4]; 2]
    }

    #[inline(always)]
    fn add(self, a: Self::F, b: Self::F) -> Self::F {
        [Portable.add(a[0], b[0]), Portable.add(a[1], b[1])]
    }

    #[inline(always)]
    fn sub(self, a: Self::F, b: Self::F) -> Self::F {
        [Portable.sub(a[0], b[0]), Portable.sub(a[1], b[1])]
    }

    #[inline(always)]
    fn mul(self, a: Self::F, b: Self::F) -> Self::F {
        [Portable.mul(a[0], b[0]), Portable.mul(a[1], b[1])]
    }

    #[inline(always)]
    fn mul_add(self, a: Self::F, b: Self::F, c: Self::F) -> Self::F {
        [Portable.mul_add(a[0], b[0], c[0]), Portable.mul_add(a[1], b[1], c[1])]
    }

    #[inline(always)]
    fn sub_mul(self, a: Self::F, b: Self::F, c: Self::F) -> Self::F {
        [Portable.sub_mul(a[0], b[0], c[0]), Portable.sub_mul(a[1], b[1], c[1])]
    }

    #[inline(always)]
    fn yzx(self, a: Self::F) -> Self::F {
        [Portable.yzx(a[0]), Portable.yzx(a[1])]
    }

    #[inline(always)]
    fn zxy(self, a: Self::F) -> Self::F {
        [Portable.zxy(a[0]), Portable.zxy(a[1])]
    }

    #[inline(always)]
    fn sum(self, a: Self::F) -> Self::F {
        [Portable.sum(a[0]), Portable.sum(a[1])]
    }
}

#[cfg(target_arch = "x86_64")]
mod x86 {
    use std::arch::x86_64::{
        __m128, __m256, _mm_add_ps, _mm_cmpge_ps, _mm_div_ps, _mm_fmadd_ps, _mm_fnmadd_ps,
        _mm_load_ps, _mm_movehl_ps, _mm_movelh_ps, _mm_movemask_ps, _mm_mul_ps, _mm_permute_ps,
        _mm_set1_ps, _mm_setr_ps, _mm_store_ps, _mm_sub_ps, _mm_unpackhi_ps, _mm_unpacklo_ps,
        _mm256_add_ps, _mm256_blend_ps, _mm256_castps256_ps128, _mm256_extractf128_ps,
        _mm256_fmadd_ps, _mm256_fnmadd_ps, _mm256_mul_ps, _mm256_permute_ps, _mm256_set_m128,
        _mm256_set1_ps, _mm256_sub_ps,
    };

    use super::{Arithmetic, Four, Kernel, Lanes};

    /// A processor with AVX2 and FMA.
    #[derive(Clone, Copy)]
    pub(super) struct Fused(());

    impl Fused {
        #[inline]
        pub(super) fn detect() -> Option<Self> {
            let has = is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma");
            has.then_some(Self(()))
        }

        #[inline]
        pub(super) fn chosen() -> Option<Self> {
            if super::PORTABLE_ASKED.load(super::Ordering::Relaxed) { None } else { Self::detect() }
        }
    }

    /// Runs `kernel`, compiled for these instructions.
    #[target_feature(enable = "avx2,fma")]
    pub(super) fn run<K: Kernel>(fused: Fused, kernel: K) -> K::Output {
        kernel.run(fused)
    }

    // SAFETY, of every block here: a `Fused` exists only where AVX2 and FMA do, and a `Four` is 16
    // aligned bytes.
    impl Arithmetic for Fused {
        type F = __m128;

        #[inline(always)]
        fn splat(self, x: f32) -> __m128 {
            unsafe { _mm_set1_ps(x) }
        }

        #[inline(always)]
        fn add(self, a: __m128, b: __m128) -> __m128 {
            unsafe { _mm_add_ps(a, b) }
        }

        #[inline(always)]
        fn sub(self, a: __m128, b: __m128) -> __m128 {
            unsafe { _mm_sub_ps(a, b) }
        }

        #[inline(always)]
        fn mul(self, a: __m128, b: __m128) -> __m128 {
            unsafe { _mm_mul_ps(a, b) }
        }

        #[inline(always)]
        fn mul_add(self, a: __m128, b: __m128, c: __m128) -> __m128 {
            unsafe { _mm_fmadd_ps(a, b, c) }
        }

        #[inline(always)]
        fn sub_mul(self, a: __m128, b: __m128, c: __m128) -> __m128 {
            unsafe { _mm_fnmadd_ps(a, b, c) }
        }

        #[inline(always)]
        fn yzx(self, a: __m128) -> __m128 {
            unsafe { _mm_permute_ps::<0b11_00_10_01>(a) }
        }

        #[inline(always)]
        fn zxy(self, a: __m128) -> __m128 {
            unsafe { _mm_permute_ps::<0b11_01_00_10>(a) }
        }

        #[inline(always)]
        fn sum(self, a: __m128) -> __m128 {
            unsafe {
                let pairs = _mm_add_ps(a, _mm_permute_ps::<0b10_11_00_01>(a));
                _mm_add_ps(pairs, _mm_permute_ps::<0b01_00_11_10>(pairs))
            }
        }
    }

    impl Lanes for Fused {
        type Two = FusedTwo;

        #[inline(always)]
        fn two(self) -> FusedTwo {
            FusedTwo(())
        }

        #[inline(always)]
        fn pair(self, a: __m128, b: __m128) -> __m256 {
            unsafe { _mm256_set_m128(b, a) }
        }

        #[inline(always)]
        fn splats(self, a: f32, b: f32) -> __m256 {
            unsafe { _mm256_blend_ps::<0b1111_0000>(_mm256_set1_ps(a), _mm256_set1_ps(b)) }
        }

        #[inline(always)]
        fn halves(self, a: __m256) -> [__m128; 2] {
            unsafe { [_mm256_castps256_ps128(a), _mm256_extractf128_ps::<1>(a)] }
        }

        #[inline(always)]
        fn load(self, from: &Four) -> __m128 {
            unsafe { _mm_load_ps(from.0.as_ptr()) }
        }

        #[inline(always)]
        fn store(self, to: &mut Four, f: __m128) {
            unsafe { _mm_store_ps(to.0.as_mut_ptr(), f) }
        }

        #[inline(always)]
        fn set(self, [x, y, z, w]: [f32; 4]) -> __m128 {
            unsafe { _mm_setr_ps(x, y, z, w) }
        }

        #[inline(always)]
        fn div(self, a: __m128, b: __m128) -> __m128 {
            unsafe { _mm_div_ps(a, b) }
        }

        #[inline(always)]
        fn lane<const LANE: usize>(self, a: __m128) -> __m128 {
            unsafe {
                match LANE {
                    0 => _mm_permute_ps::<0b00_00_00_00>(a),
                    1 => _mm_permute_ps::<0b01_01_01_01>(a),
                    2 => _mm_permute_ps::<0b10_10_10_10>(a),
                    _ => _mm_permute_ps::<0b11_11_11_11>(a),
                }
            }
        }

        #[inline(always)]
        fn at_least(self, a: __m128, b: __m128) -> u32 {
            unsafe { _mm_movemask_ps(_mm_cmpge_ps(a, b)).cast_unsigned() }
        }

        #[inline(always)]
        fn transpose(self, [a, b, c, d]: [__m128; 4]) -> [__m128; 4] {
            unsafe {
                let (ab, cd) = (_mm_unpacklo_ps(a, b), _mm_unpacklo_ps(c, d));
                let (ab_high, cd_high) = (_mm_unpackhi_ps(a, b), _mm_unpackhi_ps(c, d));
                [
                    _mm_movelh_ps(ab, cd),
                    _mm_movehl_ps(cd, ab),
                    _mm_movelh_ps(ab_high, cd_high),
                    _mm_movehl_ps(cd_high, ab_high),
                ]
            }
        }

        #[inline(always)]
        fn array(self, a: __m128) -> [f32; 4] {
            let mut four = Four::default();
            self.store(&mut four, a);
            four.0
        }
    }

    /// [`Fused`], twice; from [`Lanes::two`] alone.
    #[derive(Clone, Copy)]
    pub(super) struct FusedTwo(());

    impl Arithmetic for FusedTwo {
        type F = __m256;

        #[inline(always)]
        fn splat(self, x: f32) -> __m256 {
            unsafe { _mm256_set1_ps(x) }
        }

        #[inline(always)]
        fn add(self, a: __m256, b: __m256) -> __m256 {
            unsafe { _mm256_add_ps(a, b) }
        }

        #[inline(always)]
        fn sub(self, a: __m256, b: __m256) -> __m256 {
            unsafe { _mm256_sub_ps(a, b) }
        }

        #[inline(always)]
        fn mul(self, a: __m256, b: __m256) -> __m256 {
            unsafe { _mm256_mul_ps(a, b) }
        }

        #[inline(always)]
        fn mul_add(self, a: __m256, b: __m256, c: __m256) -> __m256 {
            unsafe { _mm256_fmadd_ps(a, b, c) }
        }

        #[inline(always)]
        fn sub_mul(self, a: __m256, b: __m256, c: __m256) -> __m256 {
            unsafe { _mm256_fnmadd_ps(a, b, c) }
        }

        #[inline(always)]
        fn yzx(self, a: __m256) -> __m256 {
            unsafe { _mm256_permute_ps::<0b11_00_10_01>(a) }
        }

        #[inline(always)]
        fn zxy(self, a: __m256) -> __m256 {
            unsafe { _mm256_permute_ps::<0b11_01_00_10>(a) }
        }

        #[inline(always)]
        fn sum(self, a: __m256) -> __m256 {
            unsafe {
                let pairs = _mm256_add_ps(a, _mm256_permute_ps::<0b10_11_00_01>(a));
                _mm256_add_ps(pairs, _mm256_permute_ps::<0b01_00_11_10>(pairs))
            }
        }
    }

    #[cfg(test)]
    mod tests {
        use super::super::Portable;
        use super::*;

        /// One of everything, on numbers that round.
        struct All([Four; 3]);

        impl Kernel for All {
            type Output = Vec<[u32; 4]>;

            #[inline(always)]
            fn run<L: Lanes>(self, l: L) -> Self::Output {
                let [a, b, c] = self.0.map(|four| l.load(&four));
                let [t0, t1, t2, t3] = l.transpose([a, b, c, l.zxy(a)]);
                let two = l.two();
                let (p, q, r) = (l.pair(a, b), l.pair(b, c), l.splats(0.3, 0.7));
                let pairs = [
                    two.splat(0.1),
                    two.add(p, q),
                    two.sub(p, r),
                    two.mul(p, q),
                    two.mul_add(p, q, r),
                    two.sub_mul(p, q, r),
                    two.yzx(p),
                    two.zxy(p),
                    two.sum(p),
                ];
                let pairs = pairs.into_iter().flat_map(|pair| l.halves(pair));
                let above = [l.at_least(a, b), l.at_least(b, a), l.at_least(a, a)];
                let all = [
                    a,
                    l.splat(0.1),
                    l.set([0.1, 0.2, 0.3, 0.4]),
                    l.add(a, b),
                    l.sub(a, b),
                    l.mul(a, b),
                    l.div(a, b),
                    l.mul_add(a, b, c),
                    l.sub_mul(a, b, c),
                    l.lane::<0>(a),
                    l.lane::<1>(a),
                    l.lane::<2>(a),
                    l.lane::<3>(a),
                    l.yzx(a),
                    l.zxy(a),
                    l.sum(a),
                    t0,
                    t1,
                    t2,
                    t3,
                ];
                let bits = all.into_iter().chain(pairs).map(|f| l.array(f).map(f32::to_bits));
                bits.chain([[above[0], above[1], above[2], 0]]).collect()
            }
        }

        #[test]
        fn both_sets_of_instructions_give_the_same_bits() {
            let Some(fused) = Fused::detect() else { return };
            for k in 1..200u16 {
                let x = |n: u16| (f32::from(k) * 0.37 + f32::from(n)).sin() * 1e3f32.powi(n.into());
                let four = |n: u16| Four([x(n), x(n + 1), x(n + 2), -x(n)]);
                let numbers = [four(0), four(1), four(2)];
                // SAFETY: `Fused` was detected.
                let fast = unsafe { run(fused, All(numbers)) };
                assert_eq!(fast, All(numbers).run(Portable));
            }
        }
    }
}
