//! The three numbers of a clock.

/// What a program costs on a machine, for vectors of any length: Hennessy and Patterson,
/// `T(n) = ceil(n / MVL) (T_loop + T_start) + n T_chime`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Charge {
    /// Elements of a strip, MVL; none where vectors of any length are worked on in one go.
    pub strip: Option<f64>,
    /// Clock periods that every strip costs, `T_loop + T_start`.
    pub each_strip: f64,
    /// Clock periods that every element costs, `T_chime`.
    pub each_element: f64,
}

impl Charge {
    /// Clock periods for vectors of `n` elements; none for empty vectors.
    pub fn clocks(&self, n: u64) -> f64 {
        let n = n as f64;
        let strips = self.strip.map_or(n.min(1.0), |length| (n / length).ceil());
        strips * self.each_strip + n * self.each_element
    }
}
