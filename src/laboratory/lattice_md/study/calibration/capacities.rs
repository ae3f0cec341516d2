//! How large the levels of memory may be: what is tried when their costs are fitted.

use super::point::BEYOND;

/// Capacities that are tried (bytes): of the store buffer, which serves what was written last before it is in any cache;
/// and of the three levels of cache what the system says, or parts of it, for programs that share the core or the last level
/// use the rest; where it says nothing, what processors have.
pub(super) fn candidates() -> Vec<[f64; BEYOND]> {
    const KIB: f64 = 1024.0;
    let known: Vec<f64> = (1..BEYOND).filter_map(cache_size).collect();
    let mut all = vec![];
    if let [l1, l2, l3] = *known.as_slice() {
        for buffer in BUFFERS {
            for (near, middle) in
                [0.5, 1.0].into_iter().flat_map(|near| [0.5, 1.0, 1.5].map(|middle| (near, middle)))
            {
                all.extend(SHARES.map(|share| [buffer, near * l1, middle * l2, share * l3]));
            }
        }
        return all;
    }
    for l1 in [32.0, 48.0, 64.0, 128.0] {
        for l2 in [256.0, 512.0, 1024.0, 2048.0, 4096.0] {
            all.extend([4.0, 8.0, 16.0, 32.0].map(|l3| [BUFFERS[1], l1 * KIB, l2 * KIB, l3 * KIB * KIB]));
        }
    }
    all
}

/// Bytes of the store buffer that are tried: some dozens of entries, each as wide as a register.
const BUFFERS: [f64; 3] = [1024.0, 2048.0, 4096.0];

/// Parts of the last level that are tried: many cores share it.
const SHARES: [f64; 5] = [0.0625, 0.125, 0.25, 0.5, 1.0];

/// Bytes of this processor's data cache of a level, where the system says it.
fn cache_size(level: usize) -> Option<f64> {
    let read = |index: usize, what: &str| {
        let path = format!("/sys/devices/system/cpu/cpu0/cache/index{index}/{what}");
        Some(std::fs::read_to_string(path).ok()?.trim().to_owned())
    };
    let of_level = |index: &usize| {
        read(*index, "level") == Some(level.to_string())
            && read(*index, "type").as_deref() != Some("Instruction")
    };
    let size = read((0..8).find(of_level)?, "size")?;
    let kib: f64 = size.strip_suffix('K')?.parse().ok()?;
    Some(1024.0 * kib)
}
