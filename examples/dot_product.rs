//! A dot product on a machine without a sum over elements: a product, then the upper half is added to the lower again and again.

use stripmine::workbench::{examine, riscv};
use stripmine_kernels::emit::GroupSize;
use stripmine_kernels::isa::Machine;
use stripmine_kernels::own::{
    Declarations, OwnKernel, OwnMachine, OwnProgram, ReadSlot, ShiftedSlot, WriteSlot,
};
use stripmine_kernels::{Execution, InstructionSet};

struct Product;

impl OwnKernel for Product {
    type Lane = f64;
    type Slots<'k> = (ReadSlot<'k>, ReadSlot<'k>, WriteSlot<'k>);
    fn declare<'k>(&self, arrays: &mut Declarations<'k>) -> Self::Slots<'k> {
        (arrays.read("x"), arrays.read("y"), arrays.write("z"))
    }
    #[inline(always)]
    fn body<'k, M: Machine<Lane = f64>>(&self, m: OwnMachine<'k, M>, &(x, y, z): &Self::Slots<'k>) {
        m.store(z, m.load(x) * m.load(y));
    }
}

/// sum = z + z at a distance of half the elements
struct Fold(usize);

impl OwnKernel for Fold {
    type Lane = f64;
    type Slots<'k> = (ReadSlot<'k>, [ShiftedSlot<'k>; 1], WriteSlot<'k>);
    fn declare<'k>(&self, arrays: &mut Declarations<'k>) -> Self::Slots<'k> {
        (arrays.read("z"), arrays.read_shifted("z", [self.0 as isize]), arrays.write("sum"))
    }
    #[inline(always)]
    fn body<'k, M: Machine<Lane = f64>>(&self, m: OwnMachine<'k, M>, &(z, [upper], sum): &Self::Slots<'k>) {
        m.store(sum, m.load(z) + m.load_shifted(upper));
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let (n, set) = (1 << 10, InstructionSet::best());
    let (x, y): (Vec<f64>, Vec<f64>) = ((1..=n).map(f64::from).collect(), vec![2.0; n as usize]);
    let (mut z, mut sum) = (vec![0.0; n as usize], vec![0.0; n as usize]);
    let product = OwnProgram::new(Product)?;
    let memory = product.memory().read("x", &x)?.read("y", &y)?.write("z", &mut z)?;
    product.run(&memory, 0..n as usize, Execution::Chained, set)?;
    drop(memory);
    for half in (0..10).rev().map(|power| 1_usize << power) {
        let fold = OwnProgram::new(Fold(half))?;
        fold.run(&fold.memory().read("z", &z)?.write("sum", &mut sum)?, 0..half, Execution::Chained, set)?;
        std::mem::swap(&mut z, &mut sum);
    }
    assert_eq!(z[0], f64::from(n * (n + 1)));
    let fold = OwnProgram::new(Fold(64))?;
    println!("{}\n{}", examine("product", &product)?, examine("fold", &fold)?);
    println!("{}", riscv("fold", &fold, GroupSize::Four)?);
    Ok(())
}
