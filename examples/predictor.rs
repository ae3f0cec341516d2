//! BP93's predictor as printed, (A1): Taylor series of two coordinates with five derivatives, each by its own product and sum.

use stripmine::workbench::{examine, riscv};
use stripmine_kernels::Program;
use stripmine_kernels::emit::GroupSize;
use stripmine_kernels::isa::{Machine, OpClass};
use stripmine_kernels::own::{Declarations, OwnKernel, OwnMachine, OwnProgram, WriteSlot};
use stripmine_kernels::printed::PrintedPredictor;

/// Derivatives 0 to 5 of x and y.
struct Predictor {
    dt: f64,
}

impl OwnKernel for Predictor {
    type Lane = f64;
    type Slots<'k> = [[WriteSlot<'k>; 6]; 2];

    fn declare<'k>(&self, arrays: &mut Declarations<'k>) -> Self::Slots<'k> {
        ["x", "y"].map(|axis| [0, 1, 2, 3, 4, 5].map(|order| arrays.write(&format!("{axis}{order}"))))
    }

    #[inline(always)]
    fn body<'k, M: Machine<Lane = f64>>(&self, m: OwnMachine<'k, M>, &axes: &Self::Slots<'k>) {
        for derivatives in axes {
            for order in 0..6 {
                let mut sum = m.load(derivatives[order]);
                let mut factor = 1.0;
                for (power, above) in (1..).zip(&derivatives[order + 1..]) {
                    factor *= self.dt / f64::from(power);
                    sum = sum + m.uniform(factor) * m.load(*above);
                }
                m.store(derivatives[order], sum);
            }
        }
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let program = OwnProgram::new(Predictor { dt: 1e-4 })?;
    // Ours and the user's have as many products and sums.
    let [own, printed] =
        [program.tape().tally(), Program::new(PrintedPredictor::<f64, 6, 2>::new(1e-4)).tape().tally()];
    for class in [OpClass::Multiply, OpClass::Add] {
        let of = |tally: &[(_, stripmine_kernels::isa::OpCounts)]| -> u64 {
            tally.iter().map(|(_, counts)| counts.of_class(class)).sum()
        };
        assert_eq!((of(&own), of(&printed)), (30, 30));
    }
    println!("{}", examine("predictor", &program)?);
    println!("{}", riscv("predictor", &program, GroupSize::Four)?);
    Ok(())
}
