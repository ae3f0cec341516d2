//! Decoding of checkpoints: any bytes give an error or the checkpoint that was written.

use super::error::CheckpointFault;
use super::{Checkpoint, CheckpointColumn, CheckpointCounter, HEADER, MAGIC, SECTION_FRAME, VERSION};
use crc32fast::Hasher;
use std::collections::{BTreeMap, HashSet};
use std::io::{self, ErrorKind, Read};

/// Fault, and its byte offset if known.
pub(super) type LocatedFault = (Option<u64>, CheckpointFault);

fn at(offset: u64, fault: CheckpointFault) -> LocatedFault {
    (Some(offset), fault)
}

/// Reader that computes a checksum.
struct ChecksumReader<R> {
    input: R,
    offset: u64,
    checksum: Hasher,
}

impl<R: Read> ChecksumReader<R> {
    fn raw(&mut self, bytes: &mut [u8]) -> Result<(), LocatedFault> {
        self.input.read_exact(bytes).map_err(|cause| at(self.offset, cause.into()))?;
        self.offset += bytes.len() as u64;
        Ok(())
    }

    fn bytes<const N: usize>(&mut self) -> Result<[u8; N], LocatedFault> {
        let mut bytes = [0; N];
        self.raw(&mut bytes)?;
        self.checksum.update(&bytes);
        Ok(bytes)
    }

    /// Compares the checksum of a part that starts at `start`.
    fn check(&mut self, start: u64, part: impl FnOnce() -> String) -> Result<(), LocatedFault> {
        let mut stated = [0; 4];
        self.raw(&mut stated)?;
        if u32::from_le_bytes(stated) == self.checksum.clone().finalize() {
            return Ok(());
        }
        Err(at(start, CheckpointFault::Checksum { part: part() }))
    }
}

/// Decodes a checkpoint of `length` bytes.
pub(super) fn decode(input: impl Read, length: u64) -> Result<Checkpoint, LocatedFault> {
    let mut source = ChecksumReader { input, offset: 0, checksum: Hasher::new() };
    if length < HEADER {
        let mut start = vec![0; length.min(MAGIC.len() as u64) as usize];
        source.raw(&mut start)?;
        return Err(if MAGIC.starts_with(&start) {
            at(length, CheckpointFault::Truncated { found: length, promised: None })
        } else {
            at(0, CheckpointFault::Magic)
        });
    }
    if source.bytes()? != MAGIC {
        return Err(at(0, CheckpointFault::Magic));
    }
    let version = u32::from_le_bytes(source.bytes()?);
    let sections = u32::from_le_bytes(source.bytes()?);
    let promised = u64::from_le_bytes(source.bytes()?);
    source.check(0, || "the header".to_owned())?;
    if version != VERSION {
        return Err(at(MAGIC.len() as u64, CheckpointFault::Version { found: version }));
    }
    if length < promised {
        return Err(at(length, CheckpointFault::Truncated { found: length, promised: Some(promised) }));
    }
    if length > promised {
        return Err(at(promised, CheckpointFault::Trailing { extra: length - promised }));
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
        return Err(at(source.offset, CheckpointFault::Trailing { extra: length - source.offset }));
    }
    if sections == 0 {
        return Err(at(length, CheckpointFault::Meaningless("it has no state")));
    }
    Ok(checkpoint)
}

/// Payload of the next section, and its byte offset.
fn section(
    source: &mut ChecksumReader<impl Read>,
    length: u64,
    i: u32,
    sections: u32,
) -> Result<(u64, Vec<u8>), LocatedFault> {
    let start = source.offset;
    let left = length - start;
    if left < SECTION_FRAME {
        return Err(at(start, CheckpointFault::Length { what: "a section", claimed: SECTION_FRAME, left }));
    }
    let kind: [u8; 4] = source.bytes()?;
    let claimed = u64::from_le_bytes(source.bytes()?);
    let left = left - SECTION_FRAME;
    if claimed > left {
        return Err(at(start + 4, CheckpointFault::Length { what: "a section", claimed, left }));
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
        return Err(at(start, CheckpointFault::Meaningless("another kind of section is expected here")));
    }
    Ok((first, payload))
}

fn state(rest: &mut Payload, checkpoint: &mut Checkpoint) -> Result<(), LocatedFault> {
    checkpoint.step = rest.u64()?;
    checkpoint.time = f64::from_bits(rest.u64()?);
    checkpoint.scene = rest.text("the scene")?;
    checkpoint.origin = rest.map("an entry of the origin", |rest| rest.text("an entry of the origin"))?;
    checkpoint.counters = rest.map("a counter", |rest| {
        let offset = rest.offset;
        let [tag] = rest.array("a counter")?;
        let bits = rest.u64()?;
        match tag {
            0 => Ok(CheckpointCounter::Count(bits)),
            1 => Ok(CheckpointCounter::Sum(f64::from_bits(bits))),
            _ => Err(at(offset, CheckpointFault::Meaningless("a counter has an unknown type"))),
        }
    })?;
    Ok(())
}

fn column(
    rest: &mut Payload,
    checkpoint: &mut Checkpoint,
    names: &mut HashSet<String>,
) -> Result<(), LocatedFault> {
    let start = rest.offset;
    let name = rest.text("the name of a column")?;
    if !names.insert(name.clone()) {
        return Err(at(start, CheckpointFault::Repeated { what: "the column", name }));
    }
    let tag_at = rest.offset;
    let [tag] = rest.array("a column")?;
    let count = rest.u64()?;
    let column = match tag {
        0 => CheckpointColumn::F64(rest.values(count, |bytes| f64::from_bits(u64::from_le_bytes(bytes)))?),
        1 => CheckpointColumn::F32(rest.values(count, |bytes| f32::from_bits(u32::from_le_bytes(bytes)))?),
        2 => CheckpointColumn::U32(rest.values(count, u32::from_le_bytes)?),
        3 => CheckpointColumn::U64(rest.values(count, u64::from_le_bytes)?),
        _ => return Err(at(tag_at, CheckpointFault::Meaningless("a column has an unknown type"))),
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
    fn take(&mut self, length: u64, what: &'static str) -> Result<&'a [u8], LocatedFault> {
        let split = usize::try_from(length).ok().and_then(|length| self.bytes.split_at_checked(length));
        let Some((taken, rest)) = split else {
            let left = self.bytes.len() as u64;
            return Err(at(self.offset, CheckpointFault::Length { what, claimed: length, left }));
        };
        self.bytes = rest;
        self.offset += length;
        Ok(taken)
    }

    fn array<const N: usize>(&mut self, what: &'static str) -> Result<[u8; N], LocatedFault> {
        let mut array = [0; N];
        array.copy_from_slice(self.take(N as u64, what)?);
        Ok(array)
    }

    fn u64(&mut self) -> Result<u64, LocatedFault> {
        Ok(u64::from_le_bytes(self.array("a number")?))
    }

    fn text(&mut self, what: &'static str) -> Result<String, LocatedFault> {
        let length = self.u64()?;
        let start = self.offset;
        let bytes = self.take(length, what)?;
        String::from_utf8(bytes.to_vec())
            .map_err(|_| at(start, CheckpointFault::Meaningless("a text is not UTF-8")))
    }

    fn map<T>(
        &mut self,
        what: &'static str,
        mut value: impl FnMut(&mut Self) -> Result<T, LocatedFault>,
    ) -> Result<BTreeMap<String, T>, LocatedFault> {
        let mut map = BTreeMap::new();
        for _ in 0..self.u64()? {
            let start = self.offset;
            let name = self.text(what)?;
            let value = value(self)?;
            if map.contains_key(&name) {
                return Err(at(start, CheckpointFault::Repeated { what, name }));
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
    ) -> Result<Vec<T>, LocatedFault> {
        let (values, beyond) = self.bytes.as_chunks::<WIDTH>();
        if values.len() as u64 != count || !beyond.is_empty() {
            let left = self.bytes.len() as u64;
            return Err(at(self.offset, CheckpointFault::Length { what: "a column", claimed: count, left }));
        }
        self.offset += self.bytes.len() as u64;
        self.bytes = &[];
        Ok(values.iter().copied().map(value).collect())
    }

    fn end(&self) -> Result<(), LocatedFault> {
        match self.bytes {
            [] => Ok(()),
            _ => Err(at(self.offset, CheckpointFault::Meaningless("a section is longer than its content"))),
        }
    }
}
