//! Force sweep written by hand with intrinsics: the reference for the machine's chained execution. The operations and their order
//! are the same, so that the results can be compared bit by bit.

/// Lattice vectors that a sweep reads.
pub struct Vectors<'a, T> {
    pub x: &'a [T],
    pub y: &'a [T],
    pub vx: &'a [T],
    pub vy: &'a [T],
    pub omega: &'a [T],
    pub radius: &'a [T],
    pub inverse_mass: &'a [T],
}

/// Parameters of the law.
#[derive(Clone, Copy)]
pub struct Numbers<T> {
    pub stiffness: T,
    pub normal_damping: T,
    pub shear_damping: T,
    pub friction: T,
}

/// A mask offset: shift, and vector between the centres of the cells.
pub type MaskNeighbour<T> = (isize, [T; 2]);

#[cfg(target_arch = "x86_64")]
macro_rules! sweep {
    ($name:ident, $feature:literal, $ty:ty, $v:ty, $lanes:literal, $load:ident $store:ident $set1:ident $add:ident
     $sub:ident $mul:ident $div:ident $sqrt:ident $min:ident $max:ident, $abs:expr, $contact:expr, $masked:expr) => {
        /// Runs one sweep; `FRICTION` as in the law, cohesionless, arms R.
        ///
        /// # Safety
        /// The processor has the feature; the shift of every offset stays inside the slices.
        #[target_feature(enable = $feature)]
        pub unsafe fn $name<const FRICTION: bool>(
            from: &Vectors<'_, $ty>,
            to: [&mut [$ty]; 3],
            range: std::ops::Range<usize>,
            neighbours: &[MaskNeighbour<$ty>],
            numbers: Numbers<$ty>,
        ) {
            use std::arch::x86_64::*;
            let [fx_to, fy_to, torque_to] = to;
            let zero = $set1(0.0);
            let one = $set1(1.0);
            let stiffness = $set1(numbers.stiffness);
            let normal_damping = $set1(numbers.normal_damping);
            let shear_damping = $set1(numbers.shear_damping);
            let friction = $set1(numbers.friction);
            let mut cell = range.start;
            while cell < range.end {
                // SAFETY: the caller keeps range and shifts inside the slices.
                unsafe {
                    let own = |column: &[$ty]| $load(column.as_ptr().add(cell));
                    let (x, y, vx, vy) = (own(from.x), own(from.y), own(from.vx), own(from.vy));
                    let (radius, weight) = (own(from.radius), own(from.inverse_mass));
                    let omega = if FRICTION { own(from.omega) } else { zero };
                    let (mut fx, mut fy, mut torque) = (zero, zero, zero);
                    for &(shift, displacement) in neighbours {
                        let at = |column: &[$ty]| $load(column.as_ptr().offset(cell as isize + shift));
                        let dx = $sub($sub(x, at(from.x)), $set1(displacement[0]));
                        let dy = $sub($sub(y, at(from.y)), $set1(displacement[1]));
                        let distance = $sqrt($add($mul(dx, dx), $mul(dy, dy)));
                        let radius_there = at(from.radius);
                        let penetration = $sub($add(radius, radius_there), distance);
                        let contact = $contact(zero, penetration);
                        let inverse = $div(one, distance);
                        let (nx, ny) = ($mul(dx, inverse), $mul(dy, inverse));
                        let (wx, wy) = ($sub(vx, at(from.vx)), $sub(vy, at(from.vy)));
                        let mass = $div(one, $add(weight, at(from.inverse_mass)));
                        let overlap = $max(penetration, zero);
                        let elastic = $mul(stiffness, $mul(overlap, $sqrt(overlap)));
                        let approach = $add($mul(wx, nx), $mul(wy, ny));
                        let damping = $mul($mul(normal_damping, mass), approach);
                        let normal = $max($sub(elastic, damping), zero);
                        let fn_ = $masked(contact, normal);
                        if FRICTION {
                            let spin = $add($mul(radius, omega), $mul(radius_there, at(from.omega)));
                            let slip = $sub($sub($mul(wy, nx), $mul(wx, ny)), spin);
                            let drag = $mul($mul(shear_damping, mass), slip);
                            let limit = $mul(friction, $abs(normal));
                            let shear = $max($min($sub(zero, drag), limit), $sub(zero, limit));
                            let fs = $masked(contact, shear);
                            fx = $add(fx, $sub($mul(fn_, nx), $mul(fs, ny)));
                            fy = $add(fy, $add($mul(fn_, ny), $mul(fs, nx)));
                            torque = $add(torque, $sub(zero, $mul(radius, fs)));
                        } else {
                            fx = $add(fx, $mul(fn_, nx));
                            fy = $add(fy, $mul(fn_, ny));
                        }
                    }
                    $store(fx_to.as_mut_ptr().add(cell), fx);
                    $store(fy_to.as_mut_ptr().add(cell), fy);
                    if FRICTION {
                        $store(torque_to.as_mut_ptr().add(cell), torque);
                    }
                }
                cell += $lanes;
            }
        }
    };
}

#[cfg(target_arch = "x86_64")]
sweep!(
    avx2_f64, "avx2", f64, __m256d, 4, _mm256_loadu_pd _mm256_storeu_pd _mm256_set1_pd _mm256_add_pd
    _mm256_sub_pd _mm256_mul_pd _mm256_div_pd _mm256_sqrt_pd _mm256_min_pd _mm256_max_pd,
    |v| _mm256_andnot_pd(_mm256_set1_pd(-0.0), v),
    |a, b| _mm256_cmp_pd::<_CMP_LT_OQ>(a, b),
    |contact, v| _mm256_and_pd(contact, v)
);
#[cfg(target_arch = "x86_64")]
sweep!(
    avx2_f32, "avx2", f32, __m256, 8, _mm256_loadu_ps _mm256_storeu_ps _mm256_set1_ps _mm256_add_ps
    _mm256_sub_ps _mm256_mul_ps _mm256_div_ps _mm256_sqrt_ps _mm256_min_ps _mm256_max_ps,
    |v| _mm256_andnot_ps(_mm256_set1_ps(-0.0), v),
    |a, b| _mm256_cmp_ps::<_CMP_LT_OQ>(a, b),
    |contact, v| _mm256_and_ps(contact, v)
);
#[cfg(target_arch = "x86_64")]
sweep!(
    avx512_f64, "avx512f", f64, __m512d, 8, _mm512_loadu_pd _mm512_storeu_pd _mm512_set1_pd _mm512_add_pd
    _mm512_sub_pd _mm512_mul_pd _mm512_div_pd _mm512_sqrt_pd _mm512_min_pd _mm512_max_pd,
    |v| _mm512_abs_pd(v),
    |a, b| _mm512_cmp_pd_mask::<_CMP_LT_OQ>(a, b),
    |contact, v| _mm512_maskz_mov_pd(contact, v)
);
#[cfg(target_arch = "x86_64")]
sweep!(
    avx512_f32, "avx512f", f32, __m512, 16, _mm512_loadu_ps _mm512_storeu_ps _mm512_set1_ps _mm512_add_ps
    _mm512_sub_ps _mm512_mul_ps _mm512_div_ps _mm512_sqrt_ps _mm512_min_ps _mm512_max_ps,
    |v| _mm512_abs_ps(v),
    |a, b| _mm512_cmp_ps_mask::<_CMP_LT_OQ>(a, b),
    |contact, v| _mm512_maskz_mov_ps(contact, v)
);
