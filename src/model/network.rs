//! A network as one more machine: what a step costs whose discs are dealt out to ranks in bands.
//!
//! ```text
//! T(R) = w N/R + g w' + 2 (α + b/β) + s ⌈log₂ R⌉ α
//!
//!        w     seconds of a disc and step on one rank with N/R discs     measured
//!        g w'  discs of rows beside the own ones that are swept again    counted
//!        b     bytes of a halo, one in each direction                    counted
//!        s     times in a step that the first rank hears or tells        counted
//! ```
//!
//! Not in it: ranks that wait for one that has more to do, other traffic, and ranks of a node that share its memory's bandwidth.

use super::quantity::Quantity;
use serde::Deserialize;

/// A network between ranks.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Network {
    /// Version of the file.
    pub format: u32,
    /// Its name.
    pub title: String,
    /// α: from one rank to another one on another node (µs).
    pub latency_us: Quantity,
    /// β of a node, in one direction (GB/s).
    pub bandwidth_gb_s: Quantity,
    /// Ranks that share it.
    pub ranks_per_node: Quantity,
}

/// The networks that come with the program.
const PRESETS: [&str; 3] = [
    include_str!("networks/infiniband-hdr.toml"),
    include_str!("networks/slingshot-11.toml"),
    include_str!("networks/ethernet-25.toml"),
];

/// The networks that come with the program.
///
/// # Errors
/// Of a text of the program that is none of a network: a test reads them all.
pub fn presets() -> Result<Vec<Network>, toml::de::Error> {
    PRESETS.into_iter().map(toml::from_str).collect()
}

/// How often the first rank hears of all or tells all in a step: the step and its report, the forces and theirs.
const COLLECTIVES: f64 = 4.0;

/// Discs that are dealt out in bands of rows.
#[derive(Clone, Debug)]
pub struct Bands {
    /// Discs.
    pub discs: f64,
    /// Rows of cells.
    pub rows: f64,
    /// Fewest rows of a band: there are no more ranks than bands.
    pub band: f64,
    /// Rows on either side of a rank's own whose discs it hears of.
    pub halo: f64,
    /// Rows of them whose pairs it meets again.
    pub again: f64,
    /// Words of 8 bytes that it hears of each.
    pub words: f64,
    /// Of the work of a disc, the part that is its pairs.
    pub pairs: f64,
}

impl Bands {
    /// The most ranks that it can be dealt out to.
    pub fn most_ranks(&self) -> f64 {
        (self.rows / self.band).floor().max(1.0)
    }

    /// Bytes of a halo in one direction.
    pub fn halo_bytes(&self) -> f64 {
        8.0 * self.words * self.halo * self.discs / self.rows
    }

    /// The part of a step in which ranks move discs of their own.
    pub fn efficiency(&self, ranks: f64, work: f64, network: &Network) -> f64 {
        work * self.discs / ranks / self.step(ranks, work, network)
    }

    /// Seconds of a step on some ranks, where a disc takes `work` seconds on a rank with as many discs as each has.
    pub fn step(&self, ranks: f64, work: f64, network: &Network) -> f64 {
        let own = work * self.discs / ranks;
        if ranks <= 1.0 {
            return own;
        }
        let again = work * self.pairs * self.again * self.discs / self.rows;
        let latency = 1e-6 * network.latency_us.value;
        // Ranks that follow each other are on one node: what leaves it is the halo of its outermost ones.
        let halo = 2.0 * (latency + self.halo_bytes() / (1e9 * network.bandwidth_gb_s.value));
        own + again + halo + COLLECTIVES * ranks.log2().ceil() * latency
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_network_states_where_each_number_comes_from() {
        for network in presets().unwrap() {
            for quantity in [&network.latency_us, &network.bandwidth_gb_s, &network.ranks_per_node] {
                assert!(quantity.value > 0.0 && !quantity.note.trim().is_empty(), "{}", network.title);
            }
        }
    }

    /// One rank has no network; with a network that costs nothing only what is done twice is left.
    #[test]
    fn a_step_costs_what_is_counted() {
        let mut network = presets().unwrap().remove(0);
        let bands =
            Bands { discs: 1e6, rows: 1000.0, band: 16.0, halo: 6.0, again: 6.0, words: 5.0, pairs: 0.5 };
        assert_eq!(bands.step(1.0, 2e-8, &network), 0.02);
        assert_eq!((bands.most_ranks(), bands.halo_bytes()), (62.0, 240_000.0));
        (network.latency_us.value, network.bandwidth_gb_s.value) = (0.0, 1e30);
        let two = bands.step(2.0, 2e-8, &network);
        assert!((two - (0.01 + 2e-8 * 0.5 * 6000.0)).abs() < 1e-12, "{two}");
        (network.latency_us.value, network.bandwidth_gb_s.value) = (1.0, 1.0);
        let more = bands.step(2.0, 2e-8, &network) - two;
        assert!((more - (2.0 * (1e-6 + 240e-6) + 4e-6)).abs() < 1e-12, "{more}");
    }
}
