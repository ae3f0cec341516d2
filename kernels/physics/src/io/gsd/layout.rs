//! Binary layout of a GSD file: heading, names and index.

/// Sizes of the heading and of an entry of the index (bytes).
pub(super) const HEADING: u64 = 256;
pub(super) const ENTRY: u64 = 32;
/// Alignment of the length of the list of names (bytes).
const NAMES: usize = 64;
/// Alignment of chunks and index (bytes), so that memory-mapped numbers are aligned.
pub(super) const ALIGNED: u64 = 8;

const MAGIC: u64 = 0x65DF_65DF_65DF_65DF;
/// First bytes of every GSD file.
pub(crate) const SIGNATURE: [u8; 8] = MAGIC.to_le_bytes();
const SCHEMA: &[u8] = b"hoomd";
const APPLICATION: &[u8] = b"stripmine";
/// Major and minor version of the schema and of the file layer.
const SCHEMA_VERSION: u32 = version(1, 4);
const FILE_VERSION: u32 = version(2, 0);

const fn version(major: u32, minor: u32) -> u32 {
    major << 16 | minor
}

/// Next offset at which a chunk or an index may start.
pub(super) const fn aligned(place: u64) -> u64 {
    place.next_multiple_of(ALIGNED)
}

/// Type of the numbers in a chunk.
pub(super) trait GsdNumber: Copy {
    /// Code of the type in the index.
    const CODE: u8;

    /// Writes its bytes.
    fn put(self, bytes: &mut [u8]);

    /// Reads a number from its bytes.
    fn of(bytes: &[u8]) -> Self;
}

macro_rules! elements {
    ($($number:ident $code:literal;)*) => {
        $(impl GsdNumber for $number {
            const CODE: u8 = $code;

            #[inline]
            fn put(self, bytes: &mut [u8]) {
                bytes.copy_from_slice(&self.to_le_bytes());
            }

            fn of(bytes: &[u8]) -> Self {
                let mut own = [0; size_of::<$number>()];
                own.copy_from_slice(bytes);
                $number::from_le_bytes(own)
            }
        })*
    };
}

elements! {
    u8 1;
    u32 3;
    u64 4;
    i8 5;
    i32 7;
    f32 9;
    f64 10;
}

/// Size of a number of a type (bytes); none for an unknown type.
const fn size_of_type(code: u8) -> Option<u64> {
    match code {
        1 | 5 | 11 => Some(1),
        2 | 6 => Some(2),
        3 | 7 | 9 => Some(4),
        4 | 8 | 10 => Some(8),
        _ => None,
    }
}

/// Offset of the index, and its number of entries.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Index {
    pub(super) at: u64,
    pub(super) capacity: u64,
}

impl Index {
    /// Offset of its end; none if it overflows.
    pub(super) fn end(self) -> Option<u64> {
        self.capacity.checked_mul(ENTRY)?.checked_add(self.at)
    }
}

/// Content of the heading.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Heading {
    pub(super) index: Index,
    /// Offset of the list of names, and its length (bytes).
    pub(super) names: [u64; 2],
}

/// Offsets of application and schema in the heading; a name has at most 63 bytes.
const APPLICATION_AT: usize = 48;
const SCHEMA_AT: usize = 112;
const SCHEMA_END: usize = 176;

impl Heading {
    /// Encodes the heading of a file.
    pub(super) fn bytes(self) -> [u8; HEADING as usize] {
        let mut bytes = [0; HEADING as usize];
        let Heading { index, names } = self;
        let wide = [MAGIC, index.at, index.capacity, names[0], names[1] / NAMES as u64];
        let narrow = [SCHEMA_VERSION, FILE_VERSION].map(u32::to_le_bytes);
        let numbers = wide.iter().flat_map(|number| number.to_le_bytes()).chain(narrow.into_iter().flatten());
        bytes.iter_mut().zip(numbers).for_each(|(byte, of)| *byte = of);
        bytes[APPLICATION_AT..][..APPLICATION.len()].copy_from_slice(APPLICATION);
        bytes[SCHEMA_AT..][..SCHEMA.len()].copy_from_slice(SCHEMA);
        bytes
    }

    /// Decodes the heading of a file written by this program, or by any program that writes the schema.
    ///
    /// # Errors
    /// The first wrong byte, and the expected content.
    pub(super) fn read(bytes: &[u8; HEADING as usize], is_own: bool) -> Result<Heading, (u64, &'static str)> {
        let wide = |number: usize| u64::of(&bytes[8 * number..][..8]);
        let names = wide(4).checked_mul(NAMES as u64).ok_or((32, "a list of names inside the file"))?;
        let heading = Heading { index: Index { at: wide(1), capacity: wide(2) }, names: [wide(3), names] };
        let own = heading.bytes();
        let differs = |from: usize, end: usize| bytes[from..end] != own[from..end];
        let checks = [
            (0, 8, "the eight bytes of the signature of a GSD file"),
            (40, 44, "version 1.4 of the schema"),
            (44, 48, "version 2.0 of the file layer"),
            (APPLICATION_AT, SCHEMA_AT, "`stripmine` as the application"),
            (SCHEMA_AT, SCHEMA_END, "`hoomd` as the schema"),
        ];
        // Other programs write other versions; their layout is that of the major version.
        let major = u16::from_le_bytes([bytes[46], bytes[47]]);
        if !is_own && bytes[..8] == own[..8] && !differs(SCHEMA_AT, SCHEMA_END) {
            return if major == 2 {
                Ok(heading)
            } else {
                Err((44, "version 2 of the file layer; `gsd.fl` of gsd 2 upgrades older files"))
            };
        }
        match checks.into_iter().find(|&(from, end, _)| differs(from, end)) {
            Some((from, _, expected)) => Err((from as u64, expected)),
            None => Ok(heading),
        }
    }
}

/// Encoded list of names, padded to its alignment.
pub(super) fn list_of(names: &[String]) -> Vec<u8> {
    let mut bytes: Vec<u8> = names.iter().flat_map(|name| name.bytes().chain([0])).collect();
    // An empty name ends the list.
    bytes.resize((bytes.len() + 1).next_multiple_of(NAMES), 0);
    bytes
}

/// Names of a list; none if it has no end or is not text.
pub(super) fn names_of(list: &[u8]) -> Option<Vec<String>> {
    let text = std::str::from_utf8(list).ok()?.strip_suffix('\0')?;
    Some(text.split('\0').take_while(|name| !name.is_empty()).map(str::to_owned).collect())
}

/// Entry of the index: location and shape of a chunk.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct IndexEntry {
    pub(super) frame: u64,
    pub(super) rows: u64,
    /// Offset of the chunk (bytes); 0 for an unused entry.
    pub(super) at: u64,
    pub(super) columns: u32,
    pub(super) name: u16,
    pub(super) code: u8,
}

impl IndexEntry {
    pub(super) fn bytes(self) -> [u8; ENTRY as usize] {
        let IndexEntry { frame, rows, at, columns, name, code } = self;
        let mut bytes = [0; ENTRY as usize];
        let wide = [frame, rows, at].into_iter().flat_map(u64::to_le_bytes).chain(columns.to_le_bytes());
        let all = wide.chain(name.to_le_bytes()).chain([code, 0]);
        bytes.iter_mut().zip(all).for_each(|(byte, of)| *byte = of);
        bytes
    }

    /// Decodes an entry.
    pub(super) fn of(bytes: &[u8]) -> IndexEntry {
        let wide = |number: usize| u64::of(&bytes[8 * number..][..8]);
        let name = u16::from_le_bytes([bytes[28], bytes[29]]);
        IndexEntry {
            frame: wide(0),
            rows: wide(1),
            at: wide(2),
            columns: u32::of(&bytes[24..28]),
            name,
            code: bytes[30],
        }
    }

    /// Offset of the chunk's end; none for an unknown type or if it overflows.
    pub(super) fn end(self) -> Option<u64> {
        let numbers = self.rows.checked_mul(self.columns.into())?;
        numbers.checked_mul(size_of_type(self.code)?)?.checked_add(self.at)
    }
}
