//! Reuse distances: how much is touched between two passes over the same vector.

use stripmine_kernels::backend::tape::{Outline, Outlines, Place, RegisterName};
use stripmine_kernels::isa::Array;

/// Bytes of a line, the least that moves between levels.
pub const LINE: f64 = 64.0;

/// A vector that a pass reads, writes or both.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Touch {
    /// Which.
    pub vector: Vector,
    /// Bytes of an element.
    pub bytes: f64,
    /// Since when it was last touched.
    pub since: Since,
    /// Whether it is written.
    pub written: bool,
    /// Whether it is met through an index vector.
    pub indexed: bool,
}

/// Where a vector was last touched.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Since {
    /// In the same program: the bytes an element of everything touched from then to now, itself included.
    Here(f64),
    /// Before this program began, or in the strip before: an array of the step.
    Before,
}

/// A register of the interpreter or an array, by its name and element type.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Vector {
    /// A register.
    Register(RegisterName),
    /// An array.
    Array(Array, &'static str),
}

/// The vector at a place, and the bytes of its elements, registers by file.
fn vector(place: &Place, register_bytes: [f64; 3]) -> (Vector, f64) {
    match *place {
        Place::Register(name) => (Vector::Register(name), register_bytes[name.file as usize]),
        Place::Memory(reference) | Place::Indexed(reference) => {
            (Vector::Array(reference.array, reference.element), element_bytes(reference.element))
        }
    }
}

impl Touch {
    /// Whether what an index vector leads to comes in order: only the images of the rim ask for entries of another index
    /// vector, and they go round it cell by cell.
    pub fn in_order(&self) -> bool {
        matches!(self.vector, Vector::Array(_, "u32"))
    }

    /// Bytes an element that go through the caches: whole lines where an index vector leads.
    fn moved(&self) -> f64 {
        if self.indexed { LINE } else { self.bytes }
    }
}

/// The vectors of a pass, each once, at no distance yet.
fn vectors(pass: &Outline, register_bytes: [f64; 3]) -> Vec<Touch> {
    let mut touches: Vec<Touch> = vec![];
    let read = pass.reads.iter().map(|place| (place, false));
    for (place, written) in read.chain(pass.writes.iter().map(|place| (place, true))) {
        let (vector, bytes) = vector(place, register_bytes);
        let indexed = matches!(place, Place::Indexed(_));
        match touches.iter_mut().find(|touch| touch.vector == vector) {
            Some(touch) => {
                touch.written |= written;
                touch.indexed &= indexed;
            }
            None => touches.push(Touch { vector, bytes, since: Since::Before, written, indexed }),
        }
    }
    touches
}

/// What every pass touches, register elements taking `register_bytes` by file.
///
/// A register that a program has not written yet was last written by the run or the strip before: the whole program lies
/// between.
pub fn touches(outlines: &Outlines, register_bytes: [f64; 3]) -> Vec<Vec<Touch>> {
    let mut passes: Vec<Vec<Touch>> =
        outlines.passes.iter().map(|pass| vectors(pass, register_bytes)).collect();
    // The least recently touched first; everything is on it once the program has run.
    let mut all: Vec<(Vector, f64)> = vec![];
    for touch in passes.iter().flatten() {
        if !all.iter().any(|(known, _)| *known == touch.vector) {
            all.push((touch.vector, touch.moved()));
        }
    }
    let all: f64 = all.iter().map(|(_, bytes)| bytes).sum();
    let mut touched: Vec<(Vector, f64)> = vec![];
    for touch in passes.iter_mut().flatten() {
        touch.since = match touched.iter().rposition(|(known, _)| *known == touch.vector) {
            Some(at) => {
                let distance = touched[at..].iter().map(|(_, bytes)| bytes).sum();
                touched.remove(at);
                Since::Here(distance)
            }
            None if matches!(touch.vector, Vector::Register(_)) => Since::Here(all),
            None => Since::Before,
        };
        touched.push((touch.vector, touch.moved()));
    }
    passes
}

/// The arrays that a program touches, each once: what a loop does that goes over all of them together.
pub fn touched_arrays(outlines: &Outlines) -> Vec<Touch> {
    let mut once: Vec<Touch> = vec![];
    for touch in touches(outlines, [0.0; 3]).into_iter().flatten() {
        match once.iter_mut().find(|known| known.vector == touch.vector) {
            Some(known) => known.written |= touch.written,
            None => once.push(touch),
        }
    }
    once.retain(|touch| touch.since == Since::Before);
    once
}

/// Bytes of an element type by its name.
pub fn element_bytes(element: &str) -> f64 {
    if element == "f64" { 8.0 } else { 4.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use stripmine_kernels::backend::tape::{File, Reference};
    use stripmine_kernels::isa::Op;

    #[test]
    fn distances_count_every_vector_once() {
        let register = |number| Place::Register(RegisterName { file: File::Number, number });
        let x = Place::Memory(Reference { array: Array::X, element: "f32", shift: 0 });
        let pass = |reads: &[Place], to| Outline {
            op: Op::Add,
            converts: false,
            reads: reads.to_vec(),
            writes: Some(to),
        };
        let passes = vec![
            pass(&[x, x], register(0)),
            pass(&[register(0), x], register(1)),
            pass(&[register(1), register(1)], register(0)),
            pass(&[register(0), x], register(0)),
        ];
        let outlines = Outlines { lane: "f64", instructions: vec![], passes, registers: [2, 0, 0] };
        let touched = touches(&outlines, [8.0, 1.0, 4.0]);
        let since: Vec<Vec<Since>> =
            touched.iter().map(|pass| pass.iter().map(|touch| touch.since).collect()).collect();
        // x, then a register not written yet: x and two registers lie behind.
        assert_eq!(since[0], [Since::Before, Since::Here(20.0)]);
        assert_eq!(since[1], [Since::Here(8.0), Since::Here(12.0), Since::Here(20.0)]);
        assert_eq!(since[2], [Since::Here(8.0), Since::Here(20.0)]);
        // A result in the register of an operand is one vector.
        assert_eq!(since[3], [Since::Here(8.0), Since::Here(20.0)]);
        assert!(touched[3][0].written && !touched[3][1].written);
    }
}
