//! The first rank: the simulation that everyone else sees.

use super::orders::Do;
use super::wire::{Record, column_like, ended, put_columns, put_failure, take_band, take_failure};
use super::worker::{Part, What, Worker};
use crate::domain::Domain;
use crate::io::checkpoint::Column;
use crate::method::pairwise::observing::{Standing, contact_sums, sums_of_grains};
use crate::method::pairwise::search::Search;
use crate::method::pairwise::{Dynamics, Elapsed, Engine, Losing, Named, Stepping, Work, wrapped};
use crate::method::{Clock, Failure, FailureKind, PerParticle};
use crate::observe::{Scenery, Sums};
use crate::particles::{Particles, States, in_space};
use crate::ranks::{Gone, Parcel, Ranks};
use std::ops::Range;
use std::thread::JoinHandle;
use stripmine_kernels::backend::Precision;
use stripmine_kernels::law::Asked;
use stripmine_kernels::sweep::fast::{Met, OfBand};

/// The first rank, which speaks for all.
pub(super) struct Ranked<S: Precision, P: Precision, Q: Search<S, P>, D: Dynamics> {
    worker: Worker<S, P, Q, D>,
    threads: Vec<JoinHandle<()>>,
    /// What all are to know before they do something: periods crossed, by rank, and whether discs are dealt out again.
    crossed: Vec<(usize, usize, [f64; 2])>,
    is_to_migrate: bool,
    shared_cells: usize,
    /// Discs that a step or its forces have given, grains first, whichever rank has them.
    named: Vec<Record>,
}

impl<S: Precision, P: Precision, Q: Search<S, P>, D: Dynamics> Ranked<S, P, Q, D> {
    /// The first rank, once all have begun.
    pub(super) fn of(
        ranks: Box<dyn Ranks>,
        threads: Vec<JoinHandle<()>>,
        part: impl FnOnce(Box<dyn Ranks>) -> Part<S, P, Q, D>,
    ) -> Result<Self, Failure> {
        let clock = Clock::default();
        let mut begun = Parcel::new();
        put_failure(None, &mut begun);
        let end = |ranks: &dyn Ranks| {
            let mut parcel = Parcel::new();
            [0, 0].into_iter().for_each(|word| parcel.push(word));
            Do::End.put(&mut parcel);
            ranks.tell(Some(parcel)).map(drop)
        };
        let worker = match part(ranks) {
            Ok(worker) => worker,
            Err((ranks, failure)) => {
                // The others have begun, or failed as well; who has ended needs not be told.
                let _ = ranks.gather(begun).and_then(|_| end(ranks.as_ref()));
                drop(ranks);
                threads.into_iter().for_each(|thread| _ = thread.join());
                return Err(failure);
            }
        };
        let all = worker.ranks.gather(begun).map_err(|gone| ended(gone, clock))?;
        let mut failures = vec![];
        for (rank, parcel) in all.iter().enumerate() {
            failures.extend(take_failure(&mut parcel.read()).map(|failure| (rank, failure)));
        }
        // Dropped where one has failed: it tells the others.
        let ranked =
            Ranked { worker, threads, crossed: vec![], is_to_migrate: false, shared_cells: 0, named: vec![] };
        first_of(failures).map(|()| ranked)
    }
}

impl<S: Precision, P: Precision, Q: Search<S, P>, D: Dynamics> Ranked<S, P, Q, D> {
    fn engine(&self) -> &Engine<S, P, Q, D> {
        &self.worker.engine
    }

    /// What all say to something that they are told to do; nothing else is to be known before it.
    fn ask(&self, what: Do) -> Result<Vec<Parcel>, Gone> {
        let mut parcel = Parcel::new();
        parcel.push(0);
        parcel.push(0);
        what.put(&mut parcel);
        self.worker.ranks.tell(Some(parcel))?;
        let own = match what {
            Do::Look(what) => self.worker.each_own(what),
            Do::Contacts => self.worker.contacts()?,
            Do::Listed => self.worker.listed(),
            _ => self.worker.unfit(),
        };
        self.worker.ranks.gather(own)
    }

    /// The same of what changes something.
    fn order(&mut self, what: Do, more: impl FnOnce(&mut Parcel)) -> Result<Vec<Parcel>, Failure> {
        let mut parcel = Parcel::new();
        let crossed = std::mem::take(&mut self.crossed);
        parcel.push(crossed.len());
        for (rank, number, periods) in crossed {
            parcel.push(rank);
            parcel.push(number);
            parcel.numbers(periods);
        }
        parcel.push(usize::from(std::mem::take(&mut self.is_to_migrate)));
        what.put(&mut parcel);
        more(&mut parcel);
        let clock = self.clock();
        let said = || -> Result<Vec<Parcel>, Gone> {
            let parcel = self.worker.ranks.tell(Some(parcel))?;
            match self.worker.follow(&mut parcel.read())? {
                Some(own) => self.worker.ranks.gather(own),
                None => Ok(vec![]),
            }
        };
        said().map_err(|gone| ended(gone, clock))
    }

    /// What came of a step: discs that moved far.
    fn heard(&mut self, reports: &[Parcel]) -> Result<Vec<u32>, Failure> {
        let (mut failures, mut far, mut shared) = (vec![], vec![], 0);
        for (rank, report) in reports.iter().enumerate() {
            let mut reader = report.read();
            failures.extend(take_failure(&mut reader).map(|failure| (rank, failure)));
            let count = reader.count();
            far.extend((0..count).map(|_| Record::take(&mut reader)));
            let count = reader.count();
            for _ in 0..count {
                let (number, periods) = (reader.count(), reader.numbers());
                if rank > 0 {
                    self.worker.engine.elapsed.crossings.add(number, periods);
                }
                self.crossed.push((rank, number, periods));
            }
            self.is_to_migrate |= reader.count() > 0;
            shared += reader.count();
        }
        self.shared_cells = shared;
        first_of(failures)?;
        Ok(self.name(far))
    }

    /// Keeps discs to be named, and gives their places.
    fn name(&mut self, discs: Vec<Record>) -> Vec<u32> {
        let mut named = discs.clone();
        named.sort_by_key(|disc| (!disc.is_grain, disc.number));
        named.dedup_by_key(|disc| disc.number);
        let at =
            |disc: &Record| named.iter().position(|it| it.number == disc.number).unwrap_or_default() as u32;
        let places = discs.iter().map(at).collect();
        self.named = named;
        places
    }

    /// For each of the scene's discs what its rank says; nothing where a rank has ended: the next step says so.
    fn each<const N: usize>(&self, what: What) -> Vec<[f64; N]> {
        let mut all = vec![[f64::NAN; N]; self.engine().start.len()];
        for parcel in self.ask(Do::Look(what)).unwrap_or_default() {
            let mut reader = parcel.read();
            for number in reader.counts() {
                all[number as usize] = reader.numbers();
            }
        }
        all
    }

    /// Position, angle and their rates of each of the scene's discs at the end of the step.
    fn standing(&self) -> Vec<[f64; 6]> {
        self.each(What::Standing)
    }

    /// The numbers of bands in their order, of all ranks.
    fn bands(reports: &[Parcel]) -> Vec<OfBand> {
        let of = |parcel: &Parcel| -> Vec<OfBand> {
            let mut reader = parcel.read();
            (0..reader.count()).map(|_| take_band(&mut reader)).collect()
        };
        reports.iter().flat_map(of).collect()
    }
}

/// The failure that one rank alone would have named, with the rank that it comes from.
fn first_of(failures: Vec<(usize, Failure)>) -> Result<(), Failure> {
    let first = |failure: &Failure| failure.culprits.first().map(|culprit| culprit.id);
    let count = failures.iter().map(|(_, failure)| failure.count).max().unwrap_or(0);
    match failures.into_iter().min_by_key(|(_, failure)| first(failure)) {
        Some((rank, failure)) => {
            let message = format!("{} (rank {rank})", failure.message);
            Err(Failure { message, count, ..failure })
        }
        None => Ok(()),
    }
}

impl<S: Precision, P: Precision, Q: Search<S, P>, D: Dynamics> Drop for Ranked<S, P, Q, D> {
    fn drop(&mut self) {
        // Who has ended already needs not be told.
        let _ = self.order(Do::End, |_| {});
        self.threads.drain(..).for_each(|thread| _ = thread.join());
    }
}

impl<S: Precision, P: Precision, Q: Search<S, P>, D: Dynamics> Named for Ranked<S, P, Q, D> {
    fn clock(&self) -> Clock {
        self.engine().clock()
    }

    fn domain(&self) -> Domain {
        self.engine().domain()
    }

    fn grains(&self) -> Range<usize> {
        0..self.named.partition_point(|disc| disc.is_grain)
    }

    fn number(&self, disc: usize) -> usize {
        self.named[disc].number
    }

    fn id(&self, disc: usize) -> u32 {
        self.named[disc].id
    }

    fn position(&self, disc: usize) -> [f64; 2] {
        self.named[disc].position
    }

    fn velocity(&self, disc: usize) -> [f64; 2] {
        self.named[disc].velocity
    }

    fn radius(&self, disc: usize) -> f64 {
        self.named[disc].radius
    }
}

impl<S: Precision, P: Precision, Q: Search<S, P>, D: Dynamics> PerParticle for Ranked<S, P, Q, D> {
    fn particles(&self) -> Particles {
        wrapped(self.unwrapped(), &self.engine().system.domain)
    }

    fn states(&self, states: &mut States) {
        let domain = self.engine().system.domain;
        for (number, [x, y, _, vx, vy, _]) in self.standing().into_iter().enumerate() {
            states.put(number, domain.wrapped([x, y]), [vx, vy]);
        }
    }

    fn positions(&self) -> Vec<[f32; 3]> {
        let domain = self.engine().system.domain;
        let place = |[x, y, ..]: [f64; 6]| domain.wrapped(in_space([x, y])).map(|along| along as f32);
        self.standing().into_iter().map(place).collect()
    }

    fn images(&self) -> Vec<[i32; 2]> {
        let (domain, crossings) = (&self.engine().system.domain, &self.engine().elapsed.crossings);
        if !crossings.follows(domain) {
            return vec![];
        }
        let image = |(number, [x, y, ..]): (usize, [f64; 6])| crossings.image(domain, number, [x, y]);
        self.standing().into_iter().enumerate().map(image).collect()
    }
}

impl<S: Precision, P: Precision, Q: Search<S, P>, D: Dynamics> Stepping for Ranked<S, P, Q, D> {
    fn advance(&mut self) -> Result<Vec<u32>, Failure> {
        let reports = self.order(Do::Advance, |_| {})?;
        self.heard(&reports)
    }

    fn compute_forces(&mut self, asked: Asked) -> Result<Met, Failure> {
        let reports = self.order(Do::Forces(asked), |_| {})?;
        let (mut failures, mut deep) = (vec![], vec![]);
        let mut of_bands = vec![];
        for (rank, report) in reports.iter().enumerate() {
            let mut reader = report.read();
            refuse(&reader.text(), self.clock())?;
            failures.extend(take_failure(&mut reader).map(|failure| (rank, failure)));
            let count = reader.count();
            of_bands.extend((0..count).map(|_| take_band(&mut reader)));
            let count = reader.count();
            deep.extend((0..2 * count).map(|_| Record::take(&mut reader)));
        }
        first_of(failures)?;
        let deep = self.name(deep).chunks_exact(2).map(|pair| [pair[0], pair[1]]).collect();
        Ok(Met { deep, ..Met::of(of_bands) })
    }

    fn elapsed(&self) -> &Elapsed {
        &self.engine().elapsed
    }

    fn elapsed_mut(&mut self) -> &mut Elapsed {
        &mut self.worker.engine.elapsed
    }

    fn start(&self) -> &Particles {
        &self.engine().start
    }

    fn shared_cells(&self) -> usize {
        self.shared_cells
    }

    fn lists(&self) -> Option<(usize, u64)> {
        let made = self.engine().search.lists()?.made();
        let listed = self.ask(Do::Listed).unwrap_or_default();
        Some((listed.iter().map(|parcel| parcel.read().count()).sum(), made))
    }

    fn unwrapped(&self) -> Particles {
        let mut particles = Particles::clone(&self.engine().start);
        let grains = particles.grain_count();
        let walls = in_space(self.engine().prescribed().unwrap_or_default().velocity);
        let standing = self.standing();
        for (number, (particle, [x, y, angle, vx, vy, omega])) in
            particles.all_mut().iter_mut().zip(standing).enumerate()
        {
            particle.position = in_space([x, y]);
            if number < grains {
                (particle.velocity, particle.angle, particle.omega) = (in_space([vx, vy]), angle, omega);
            } else {
                particle.velocity = walls;
            }
        }
        particles
    }

    fn forces(&self) -> Vec<[f64; 3]> {
        self.each(What::Forces)
    }

    fn columns(&self) -> Vec<(String, Column)> {
        let like = self.engine().columns_of(&[]).into_iter().enumerate();
        let columns = like.map(|(place, (name, like))| {
            let values = self.each(What::Column(place)).into_iter().map(|[value]| value).collect();
            (name, column_like(&like, values))
        });
        columns.chain(self.engine().columns_of_all()).collect()
    }

    fn restore(&mut self, steps: u64, columns: &[(String, Column)]) -> Result<(), String> {
        self.is_to_migrate = false;
        let reports = self.order(Do::Restore, |parcel| {
            parcel.push(steps as usize);
            put_columns(columns, parcel);
        });
        let reports = reports.map_err(|failure| failure.what())?;
        let why = reports.iter().map(|parcel| parcel.read().text()).find(|why| !why.is_empty());
        why.map_or(Ok(()), Err)
    }

    fn sums(&self, scenery: &Scenery, work: &Work<'_>) -> Sums {
        let standing = self.standing();
        let grains = sums_of_grains(self.engine().start.grains(), (scenery, work), |number| {
            let [x, y, _, vx, vy, omega] = standing[number];
            Standing { position: [x, y], velocity: [vx, vy], omega }
        });
        let reports = self.ask(Do::Contacts).unwrap_or_default();
        let met = Met::of(Self::bands(&reports));
        Sums { grains, contacts: contact_sums(&met) }
    }
}

impl<S: Precision, P: Precision, Q: Search<S, P>, D: Dynamics> Losing for Ranked<S, P, Q, D> {
    fn predicted_velocities(&self) -> Vec<[f64; 2]> {
        self.each(What::Velocities)
    }

    fn skip_forces(&mut self) {
        // What a rank says that has ended, the next step says.
        let _ = self.order(Do::SkipForces, |_| {});
    }

    fn unfit(&self) -> Vec<usize> {
        let all = self.ask(Do::Unfit).unwrap_or_default();
        let mut unfit: Vec<usize> =
            all.iter().flat_map(|parcel| parcel.read().counts()).map(|number| number as usize).collect();
        unfit.sort_unstable();
        unfit
    }

    fn settle(&mut self) -> Result<(), Failure> {
        let reports = self.order(Do::Settle, |_| {})?;
        self.is_to_migrate = true;
        self.heard(&reports).map(drop)
    }
}

/// A failure of what a rank says that went wrong, if it says something.
fn refuse(why: &str, at: Clock) -> Result<(), Failure> {
    if why.is_empty() {
        return Ok(());
    }
    let what = format!("discs cannot be dealt out to the ranks: {why}");
    let remedy = "report this with the scene";
    Err(Failure::new(FailureKind::MACHINE, what, remedy).at(at))
}
