//! Means of a function over blocks of a run, with their error bars.

use crate::averages::student;
use crate::structure::{Block, widening};

/// Smallest number of blocks for error bars, in the second half of a run.
const FEWEST_BLOCKS: usize = 2;

/// Arguments of a function, its means with error bars, and its values in each block.
pub(super) struct BlockFunction {
    pub(super) over: Vec<Vec<f64>>,
    /// Means; NaN if fewer than two blocks have a value.
    pub(super) means: Vec<[f64; 2]>,
    pub(super) blocks: Vec<Block>,
    /// Lags (samples), for functions of lags, and the samples of a block.
    pub(super) lags: Vec<u64>,
    pub(super) length: u64,
}

impl BlockFunction {
    /// Weighted mean over blocks at an index, with its error bar; none if there are too few blocks.
    pub(super) fn mean_at(&self, place: usize) -> Option<[f64; 2]> {
        self.weighted(|block| [block.means[place], block.weights[place]], place)
    }

    /// Mean over blocks of a number computed from each, with its error bar; none if there are too few blocks. `place` is the index of the largest
    /// lag that the number uses.
    pub(super) fn mean(&self, of: impl Fn(&Block) -> f64, place: usize) -> Option<[f64; 2]> {
        self.weighted(|block| [of(block), 1.0], place)
    }

    fn weighted(&self, of: impl Fn(&Block) -> [f64; 2], place: usize) -> Option<[f64; 2]> {
        if self.blocks.len() < FEWEST_BLOCKS {
            return None;
        }
        let values: Vec<[f64; 2]> = self.blocks.iter().map(of).filter(|[value, _]| !value.is_nan()).collect();
        let [mean, bar] = mean_of_weighted(&values);
        let wider = self.lags.get(place).map_or(1.0, |&lag| widening(lag, self.length, values.len()));
        Some([mean, wider * bar])
    }

    /// Reason why the function has no values, with the number of samples that would suffice.
    pub(super) fn missing(&self, looks: u64, every: u64) -> Option<String> {
        let needed = 2 * (FEWEST_BLOCKS as u64 + 1);
        let rarer = match every {
            1 => String::new(),
            every => format!(", or a larger output.structure_share: only every {every}th is sampled"),
        };
        let why = match () {
            () if looks < needed && self.blocks.len() < FEWEST_BLOCKS => {
                format!("too few samples, {looks}: a first error bar needs {needed}{rarer}")
            }
            () if self.blocks.len() < FEWEST_BLOCKS || self.means.iter().all(|[mean, _]| mean.is_nan()) => {
                format!("there was no value in {looks} samples{rarer}")
            }
            () => return None,
        };
        Some(why)
    }
}

/// Weighted mean of values as a ratio of sums, and the half-width of its 95 % confidence interval by Student's t. The degrees of freedom are those
/// of the effective number of values. NaN if fewer than two have weight.
fn mean_of_weighted(values: &[[f64; 2]]) -> [f64; 2] {
    let sum = |of: &dyn Fn(f64, f64) -> f64| values.iter().map(|&[x, w]| of(x, w)).sum::<f64>();
    let (all, squares) = (sum(&|_, w| w), sum(&|_, w| w * w));
    let (count, alike) = (values.len() as f64, all * all / squares);
    if values.len() < FEWEST_BLOCKS || all <= 0.0 {
        return [f64::NAN; 2];
    }
    let mean = sum(&|x, w| w * x) / all;
    let square = sum(&|x, w| (w * (x - mean)).powi(2)) / (all * all) * count / (count - 1.0);
    let freedoms = (alike - 1.0).round().max(1.0) as usize;
    [mean, student(0.95, freedoms) * square.sqrt()]
}
