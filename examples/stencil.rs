//! A five-point stencil by shifts: a step of heat conduction on a grid whose rows lie one after the other in a vector.

use stripmine::workbench::{examine, riscv};
use stripmine_kernels::emit::GroupSize;
use stripmine_kernels::isa::Machine;
use stripmine_kernels::own::{
    Declarations, OwnKernel, OwnMachine, OwnProgram, ReadSlot, ShiftedSlot, WriteSlot,
};
use stripmine_kernels::{Execution, InstructionSet};

struct HeatStep {
    columns: isize,
    share: f64,
}

impl OwnKernel for HeatStep {
    type Lane = f64;
    type Slots<'k> = ([ShiftedSlot<'k>; 4], ReadSlot<'k>, WriteSlot<'k>);

    fn declare<'k>(&self, arrays: &mut Declarations<'k>) -> Self::Slots<'k> {
        let around = [-1, 1, -self.columns, self.columns];
        (arrays.read_shifted("u", around), arrays.read("u"), arrays.write("next"))
    }

    #[inline(always)]
    fn body<'k, M: Machine<Lane = f64>>(&self, m: OwnMachine<'k, M>, &(around, u, next): &Self::Slots<'k>) {
        m.section("neighbours");
        let [west, east, south, north] = around.map(|slot| m.load_shifted(slot));
        m.section("heat");
        let own = m.load(u);
        let around = (west + east) + (south + north);
        m.store(next, own + m.uniform(self.share) * (around - m.uniform(4.0) * own));
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let columns = 32;
    let program = OwnProgram::new(HeatStep { columns: columns as isize, share: 0.25 })?;
    // A hot cell spreads to its four neighbours.
    let (mut u, mut next) = (vec![0.0; columns * 8], vec![0.0; columns * 8]);
    u[columns * 4 + 10] = 1.0;
    let memory = program.memory().read("u", &u)?.write("next", &mut next)?;
    program.run(&memory, program.interior(u.len()), Execution::Chained, InstructionSet::best())?;
    drop(memory);
    for at in [columns * 4 + 9, columns * 4 + 11, columns * 3 + 10, columns * 5 + 10] {
        assert_eq!(next[at], 0.25);
    }
    println!("{}", examine("stencil", &program)?);
    println!("{}", riscv("stencil", &program, GroupSize::Four)?);
    Ok(())
}
