//! Encoding of checkpoints.

use super::{Checkpoint, CheckpointColumn, CheckpointCounter, HEADER, MAGIC, SECTION_FRAME, VERSION};
use crate::io::FileError;
use crc32fast::Hasher;
use std::collections::BTreeMap;
use std::io::{self, Write};

/// Reason why a checkpoint cannot be written.
#[derive(Debug, thiserror::Error)]
pub enum WriteError {
    /// The system refuses to write it.
    #[error(transparent)]
    File(#[from] FileError),
    /// Two columns have the same name.
    #[error("two columns have the name `{0}`; give each column its own name")]
    RepeatedColumn(String),
}

/// Writer that computes a checksum.
struct ChecksumWriter<W> {
    out: W,
    checksum: Hasher,
}

impl<W: Write> ChecksumWriter<W> {
    fn put(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.checksum.update(bytes);
        self.out.write_all(bytes)
    }

    fn put_checksum(&mut self) -> io::Result<()> {
        self.out.write_all(&self.checksum.clone().finalize().to_le_bytes())
    }
}

impl Checkpoint {
    /// Writes the whole file.
    pub(super) fn encode(&self, out: impl Write) -> io::Result<()> {
        let state = self.state();
        let columns: u64 =
            self.columns.iter().map(|(name, column)| SECTION_FRAME + column_bytes(name, column)).sum();
        let mut sink = ChecksumWriter { out, checksum: Hasher::new() };
        sink.put(&MAGIC)?;
        sink.put(&VERSION.to_le_bytes())?;
        sink.put(&(self.columns.len() as u32 + 1).to_le_bytes())?;
        sink.put(&(HEADER + SECTION_FRAME + state.len() as u64 + columns).to_le_bytes())?;
        sink.put_checksum()?;

        sink.put(b"STAT")?;
        sink.put(&(state.len() as u64).to_le_bytes())?;
        sink.put(&state)?;
        sink.put_checksum()?;

        for (name, column) in &self.columns {
            sink.put(b"COLM")?;
            sink.put(&column_bytes(name, column).to_le_bytes())?;
            let mut head = Vec::new();
            push_text(&mut head, name);
            head.push(column.tag_and_width().0);
            head.extend((column.len() as u64).to_le_bytes());
            sink.put(&head)?;
            match column {
                CheckpointColumn::F64(values) => {
                    put_all(&mut sink, values, |value| value.to_bits().to_le_bytes())?
                }
                CheckpointColumn::F32(values) => {
                    put_all(&mut sink, values, |value| value.to_bits().to_le_bytes())?
                }
                CheckpointColumn::U32(values) => put_all(&mut sink, values, |value| value.to_le_bytes())?,
                CheckpointColumn::U64(values) => put_all(&mut sink, values, |value| value.to_le_bytes())?,
            }
            sink.put_checksum()?;
        }
        sink.out.flush()
    }

    /// Payload of `STAT`.
    fn state(&self) -> Vec<u8> {
        let mut bytes = Vec::new();
        bytes.extend(self.step.to_le_bytes());
        bytes.extend(self.time.to_bits().to_le_bytes());
        push_text(&mut bytes, &self.scene);
        push_map(&mut bytes, &self.origin, |bytes, text| push_text(bytes, text));
        push_map(&mut bytes, &self.counters, |bytes, counter| {
            let (tag, bits) = match counter {
                CheckpointCounter::Count(count) => (0, *count),
                CheckpointCounter::Sum(sum) => (1, sum.to_bits()),
            };
            bytes.push(tag);
            bytes.extend(bits.to_le_bytes());
        });
        bytes
    }
}

/// Size of the payload of `COLM` (bytes).
fn column_bytes(name: &str, column: &CheckpointColumn) -> u64 {
    8 + name.len() as u64 + 1 + 8 + column.len() as u64 * column.tag_and_width().1
}

fn push_text(bytes: &mut Vec<u8>, text: &str) {
    bytes.extend((text.len() as u64).to_le_bytes());
    bytes.extend(text.as_bytes());
}

fn push_map<T>(bytes: &mut Vec<u8>, map: &BTreeMap<String, T>, push: impl Fn(&mut Vec<u8>, &T)) {
    bytes.extend((map.len() as u64).to_le_bytes());
    for (name, value) in map {
        push_text(bytes, name);
        push(bytes, value);
    }
}

fn put_all<W: Write, T, const WIDTH: usize>(
    sink: &mut ChecksumWriter<W>,
    values: &[T],
    bytes_of: impl Fn(&T) -> [u8; WIDTH],
) -> io::Result<()> {
    const CHUNK: usize = 8192;
    let mut bytes = Vec::with_capacity(CHUNK * WIDTH);
    for chunk in values.chunks(CHUNK) {
        bytes.clear();
        chunk.iter().for_each(|value| bytes.extend(bytes_of(value)));
        sink.put(&bytes)?;
    }
    Ok(())
}
