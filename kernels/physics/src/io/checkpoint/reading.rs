//! Decoding of checkpoints: any bytes give an error or the checkpoint that was written.

use super::error::Fault;
use super::{Checkpoint, Column, Counter, HEADER, MAGIC, SECTION_FRAME, VERSION};
use crc32fast::Hasher;
use std::collections::{BTreeMap, HashSet};
use std::io::{self, ErrorKind, Read};

/// Fault, and its byte offset if known.
pub(super) type Found = (Option<u64>, Fault);

fn at(offset: u64, fault: Fault) -> Found {
    (Some(offset), fault)
}

/// Reader that computes a checksum.
struct Source<R> {
    input: R,
    offset: u64,
    checksum: Hasher,
}

impl<R: Read> Source<R> {
    fn raw(&mut self, bytes: &mut [u8]) -> Result<(), Found> {
        self.input.read_exact(bytes).map_err(|cause| at(self.offset, cause.into()))?;
        self.offset += bytes.len() as u64;
        Ok(())
    }

    fn bytes<const N: usize>(&mut self) -> Result<[u8; N], Found> {
        let mut bytes = [0; N];
        self.raw(&mut bytes)?;
        self.checksum.update(&bytes);
        Ok(bytes)
    }

    /// Compares the checksum of a part that starts at `start`.
    fn check(&mut self, start: u64, part: impl FnOnce() -> String) -> Result<(), Found> {
        let mut stated = [0; 4];
        self.raw(&mut stated)?;
        if u32::from_le_bytes(stated) == self.checksum.clone().finalize() {
            return Ok(());
        }
        Err(at(start, Fault::Checksum { part: part() }))
    }
}

/// Decodes a checkpoint of `length` bytes.
pub(super) fn decode(input: impl Read, length: u64) -> Result<Checkpoint, Found> {
    let mut source = Source { input, offset: 0, checksum: Hasher::new() };
    if length < HEADER {
        let mut start = vec![0; length.min(MAGIC.len() as u64) as usize];
        source.raw(&mut start)?;
        return Err(if MAGIC.starts_with(&start) {
            at(length, Fault::Truncated { found: length, promised: None })
        } else {
            at(0, Fault::Magic)
        });
    }
    if source.bytes()? != MAGIC {
        return Err(at(0, Fault::Magic));
    }
    let version = u32::from_le_bytes(source.bytes()?);
    let sections = u32::from_le_bytes(source.bytes()?);
    let promised = u64::from_le_bytes(source.bytes()?);
    source.check(0, || "the header".to_owned())?;
    if version != VERSION {
        return Err(at(MAGIC.len() as u64, Fault::Version { found: version }));
    }
    if length < promised {
        return Err(at(length, Fault::Truncated { found: length, promised: Some(promised) }));
    }
    if length > promised {
        return Err(at(promised, Fault::Trailing { extra: length - promised }));
    }
    let mut checkpoint = Checkpoint::default();
    let mut names = HashSet::new();
    for i in 0..sections {
        let (start, payload) = section(&mut source, length, i, sections)?;
        let mut rest = Payload { bytes: &payload, offset: start };
        if i == 0 {
            state(&mut rest, &mut checkpoint)?;
        } else {
            column(&mut rest, &mut checkpoint, &mut names)?;
        }
        rest.end()?;
    }
    if source.offset < length {
        return Err(at(source.offset, Fault::Trailing { extra: length - source.offset }));
    }
    if sections == 0 {
        return Err(at(length, Fault::Meaningless("it has no state")));
    }
    Ok(checkpoint)
}

/// Payload of the next section, and its byte offset.
fn section(
    source: &mut Source<impl Read>,
    length: u64,
    i: u32,
    sections: u32,
) -> Result<(u64, Vec<u8>), Found> {
    let start = source.offset;
    let left = length - start;
    if left < SECTION_FRAME {
        return Err(at(start, Fault::Length { what: "a section", claimed: SECTION_FRAME, left }));
    }
    let kind: [u8; 4] = source.bytes()?;
    let claimed = u64::from_le_bytes(source.bytes()?);
    let left = left - SECTION_FRAME;
    if claimed > left {
        return Err(at(start + 4, Fault::Length { what: "a section", claimed, left }));
    }
    let first = source.offset;
    let mut payload = Vec::new();
    let memory = |_| at(start, io::Error::from(ErrorKind::OutOfMemory).into());
    payload.try_reserve_exact(claimed as usize).map_err(memory)?;
    payload.resize(claimed as usize, 0);
    source.raw(&mut payload)?;
    source.checksum.update(&payload);
    source.check(start, || match i {
        0 => "the state".to_owned(),
        _ => format!("column {i} of {}", sections - 1),
    })?;
    if kind != *if i == 0 { b"STAT" } else { b"COLM" } {
        return Err(at(start, Fault::Meaningless("another kind of section is expected here")));
    }
    Ok((first, payload))
}

fn state(rest: &mut Payload, checkpoint: &mut Checkpoint) -> Result<(), Found> {
    checkpoint.step = rest.u64()?;
    checkpoint.time = f64::from_bits(rest.u64()?);
    checkpoint.scene = rest.text("the scene")?;
    checkpoint.origin = rest.map("an entry of the origin", |rest| rest.text("an entry of the origin"))?;
    checkpoint.counters = rest.map("a counter", |rest| {
        let offset = rest.offset;
        let [tag] = rest.array("a counter")?;
        let bits = rest.u64()?;
        match tag {
            0 => Ok(Counter::Count(bits)),
            1 => Ok(Counter::Sum(f64::from_bits(bits))),
            _ => Err(at(offset, Fault::Meaningless("a counter has an unknown type"))),
        }
    })?;
    Ok(())
}

fn column(rest: &mut Payload, checkpoint: &mut Checkpoint, names: &mut HashSet<String>) -> Result<(), Found> {
    let start = rest.offset;
    let name = rest.text("the name of a column")?;
    if !names.insert(name.clone()) {
        return Err(at(start, Fault::Repeated { what: "the column", name }));
    }
    let tag_at = rest.offset;
    let [tag] = rest.array("a column")?;
    let count = rest.u64()?;
    let column = match tag {
        0 => Column::F64(rest.values(count, |bytes| f64::from_bits(u64::from_le_bytes(bytes)))?),
        1 => Column::F32(rest.values(count, |bytes| f32::from_bits(u32::from_le_bytes(bytes)))?),
        2 => Column::U32(rest.values(count, u32::from_le_bytes)?),
        3 => Column::U64(rest.values(count, u64::from_le_bytes)?),
        _ => return Err(at(tag_at, Fault::Meaningless("a column has an unknown type"))),
    };
    checkpoint.columns.push((name, column));
    Ok(())
}

/// Rest of a payload, and its byte offset in the file.
struct Payload<'a> {
    bytes: &'a [u8],
    offset: u64,
}

impl<'a> Payload<'a> {
    fn take(&mut self, length: u64, what: &'static str) -> Result<&'a [u8], Found> {
        let split = usize::try_from(length).ok().and_then(|length| self.bytes.split_at_checked(length));
        let Some((taken, rest)) = split else {
            let left = self.bytes.len() as u64;
            return Err(at(self.offset, Fault::Length { what, claimed: length, left }));
        };
        self.bytes = rest;
        self.offset += length;
        Ok(taken)
    }

    fn array<const N: usize>(&mut self, what: &'static str) -> Result<[u8; N], Found> {
        let mut array = [0; N];
        array.copy_from_slice(self.take(N as u64, what)?);
        Ok(array)
    }

    fn u64(&mut self) -> Result<u64, Found> {
        Ok(u64::from_le_bytes(self.array("a number")?))
    }

    fn text(&mut self, what: &'static str) -> Result<String, Found> {
        let length = self.u64()?;
        let start = self.offset;
        let bytes = self.take(length, what)?;
        String::from_utf8(bytes.to_vec()).map_err(|_| at(start, Fault::Meaningless("a text is not UTF-8")))
    }

    fn map<T>(
        &mut self,
        what: &'static str,
        mut value: impl FnMut(&mut Self) -> Result<T, Found>,
    ) -> Result<BTreeMap<String, T>, Found> {
        let mut map = BTreeMap::new();
        for _ in 0..self.u64()? {
            let start = self.offset;
            let name = self.text(what)?;
            let value = value(self)?;
            if map.contains_key(&name) {
                return Err(at(start, Fault::Repeated { what, name }));
            }
            map.insert(name, value);
        }
        Ok(map)
    }

    /// Reads the rest, which must be `count` values.
    fn values<T, const WIDTH: usize>(
        &mut self,
        count: u64,
        value: impl Fn([u8; WIDTH]) -> T,
    ) -> Result<Vec<T>, Found> {
        let (values, beyond) = self.bytes.as_chunks::<WIDTH>();
        if values.len() as u64 != count || !beyond.is_empty() {
            let left = self.bytes.len() as u64;
            return Err(at(self.offset, Fault::Length { what: "a column", claimed: count, left }));
        }
        self.offset += self.bytes.len() as u64;
        self.bytes = &[];
        Ok(values.iter().copied().map(value).collect())
    }

    fn end(&self) -> Result<(), Found> {
        match self.bytes {
            [] => Ok(()),
            _ => Err(at(self.offset, Fault::Meaningless("a section is longer than its content"))),
        }
    }
}
