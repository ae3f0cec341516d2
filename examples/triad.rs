//! STREAM's triad, a = b + s c, as a program of your own.

use stripmine::workbench::{examine, riscv};
use stripmine_kernels::emit::GroupSize;
use stripmine_kernels::isa::Machine;
use stripmine_kernels::own::{Declarations, OwnKernel, OwnMachine, OwnProgram, ReadSlot, WriteSlot};
use stripmine_kernels::{Execution, InstructionSet};

struct Triad {
    s: f64,
}

impl OwnKernel for Triad {
    type Lane = f64;
    type Slots<'k> = (ReadSlot<'k>, ReadSlot<'k>, WriteSlot<'k>);

    fn declare<'k>(&self, arrays: &mut Declarations<'k>) -> Self::Slots<'k> {
        (arrays.read("b"), arrays.read("c"), arrays.write("a"))
    }

    #[inline(always)]
    fn body<'k, M: Machine<Lane = f64>>(&self, m: OwnMachine<'k, M>, &(b, c, a): &Self::Slots<'k>) {
        m.store(a, m.load(b) + m.uniform(self.s) * m.load(c));
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let program = OwnProgram::new(Triad { s: 3.0 })?;
    let (b, c, mut a) = (vec![1.0; 1000], vec![2.0; 1000], vec![0.0; 1000]);
    let memory = program.memory().read("b", &b)?.read("c", &c)?.write("a", &mut a)?;
    program.run(&memory, 0..1000, Execution::Chained, InstructionSet::best())?;
    drop(memory);
    assert_eq!(a, vec![7.0; 1000]);
    println!("{}", examine("triad", &program)?);
    println!("{}", riscv("triad", &program, GroupSize::Four)?);
    Ok(())
}
