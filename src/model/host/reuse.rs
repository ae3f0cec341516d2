//! Reuse distances: how much is touched between two passes over the same vector.

use stripmine_kernels::backend::tape::{Outlines, Place, RegisterName};
use stripmine_kernels::isa::Array;

/// A vector that a pass touches.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Touch {
    /// Bytes of an element.
    pub bytes: f64,
    /// Since when it was last touched.
    pub since: Since,
}

/// Where a vector was last touched.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Since {
    /// In the same program: the bytes an element of everything touched from then to now, itself included.
    Here(f64),
    /// Before this program began, or in the strip before: an array of the step.
    Before,
}

#[derive(Clone, Copy, PartialEq)]
enum Vector {
    Register(RegisterName),
    Array(Array, &'static str),
}

/// What every pass touches, register elements taking `register_bytes` by file.
///
/// A register that a program has not written yet was written when the register files were made, or by the strip before:
/// the whole program lies between.
pub fn touches(outlines: &Outlines, register_bytes: [f64; 3]) -> Vec<Vec<Touch>> {
    let seen = |place: &Place| match *place {
        Place::Register(name) => (Vector::Register(name), register_bytes[name.file as usize]),
        Place::Memory(reference) | Place::Indexed(reference) => {
            (Vector::Array(reference.array, reference.element), element_bytes(reference.element))
        }
    };
    // The least recently touched first; everything is on it once the program has run.
    let mut stack: Vec<(Vector, f64)> = vec![];
    for pass in &outlines.passes {
        for place in pass.reads.iter().chain(&pass.writes) {
            let vector = seen(place);
            if !stack.iter().any(|(known, _)| *known == vector.0) {
                stack.push(vector);
            }
        }
    }
    let all: f64 = stack.iter().map(|(_, bytes)| bytes).sum();
    let mut touched: Vec<(Vector, f64)> = vec![];
    let mut touch = |place: &Place| {
        let (vector, bytes) = seen(place);
        let since = match touched.iter().rposition(|(known, _)| *known == vector) {
            Some(at) => {
                let distance = touched[at..].iter().map(|(_, bytes)| bytes).sum();
                touched.remove(at);
                Since::Here(distance)
            }
            None if matches!(vector, Vector::Register(_)) => Since::Here(all),
            None => Since::Before,
        };
        touched.push((vector, bytes));
        Touch { bytes, since }
    };
    let of_pass = outlines.passes.iter().map(|pass| {
        // A result in the register of an operand is one vector touched twice: at no distance.
        pass.reads.iter().chain(&pass.writes).map(&mut touch).collect()
    });
    of_pass.collect()
}

/// Bytes of an element type by its name.
pub fn element_bytes(element: &str) -> f64 {
    if element == "f64" { 8.0 } else { 4.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use stripmine_kernels::backend::tape::{File, Outline, Reference};
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
        ];
        let outlines = Outlines { lane: "f64", instructions: vec![], passes, registers: [2, 0, 0] };
        let since: Vec<Vec<Since>> = touches(&outlines, [8.0, 1.0, 4.0])
            .into_iter()
            .map(|pass| pass.into_iter().map(|touch| touch.since).collect())
            .collect();
        // x, then x again, then a register not written yet: x and two registers lie behind.
        assert_eq!(since[0], [Since::Before, Since::Here(4.0), Since::Here(20.0)]);
        assert_eq!(since[1], [Since::Here(8.0), Since::Here(12.0), Since::Here(20.0)]);
        assert_eq!(since[2], [Since::Here(8.0), Since::Here(8.0), Since::Here(20.0)]);
    }
}
