//! First rank: the simulation that all other code uses.

use super::wire::{
    CrossedPeriods, DiscRecord, Do, ForcesReport, RankOrder, RankSample, StepReport, column_like,
    store_rank_values,
};
use super::worker::{PartStart, RankPart};
use crate::domain::Domain;
use crate::io::checkpoint::CheckpointColumn;
use crate::method::pairwise::observing::{StepEndDisc, contact_sums, sums_of_grains};
use crate::method::pairwise::{Elapsed, GravityWork, NameableDiscs, RemovableDiscs, SteppingDiscs, wrapped};
use crate::method::{Clock, FailureKind, PerParticle, PhysicsFailure, rank_loss_failure};
use crate::observe::{ObservationSums, SceneProperties};
use crate::particles::{GrainStates, Particles, in_space};
use crate::ranks::{Parcel, RankError, Ranks};
use serde::de::DeserializeOwned;
use std::cell::OnceCell;
use std::ops::Range;
use std::thread::JoinHandle;
use stripmine_kernels::law::ObservationRequest;
use stripmine_kernels::sweep::fast::{BandReport, SweepReport};

/// First rank, which represents all.
pub(super) struct FirstRank {
    worker: Box<dyn RankPart>,
    /// Dropped after the worker: a rank that waits for the first one ends when the first one's end of the channel is closed.
    _threads: RankThreads,
    /// News for all ranks before their next order: crossed periods by rank, and whether to redistribute discs.
    crossed: Vec<(usize, CrossedPeriods)>,
    is_to_migrate: bool,
    shared_cells: usize,
    /// Discs reported by a step or its forces, grains first, from any rank.
    named: Vec<DiscRecord>,
    /// Reason why the other ranks were ended: the first loss detected by a step or a sample. Samples since then lack a rank; every later step and
    /// check fails with this reason.
    stopped: OnceCell<PhysicsFailure>,
}

/// Threads of ranks, joined on drop.
pub(super) struct RankThreads(pub(super) Vec<JoinHandle<()>>);

impl Drop for RankThreads {
    fn drop(&mut self) {
        self.0.drain(..).for_each(|thread| _ = thread.join());
    }
}

impl FirstRank {
    /// Builds the first rank after all have started.
    pub(super) fn of(
        ranks: Box<dyn Ranks>,
        threads: RankThreads,
        part: impl FnOnce(Box<dyn Ranks>) -> PartStart,
    ) -> Result<Self, PhysicsFailure> {
        let worker = match part(ranks) {
            Ok(worker) => worker,
            Err((ranks, failure)) => {
                // The others have started, or failed as well.
                #[expect(clippy::let_underscore_must_use, reason = "a rank that has ended needs no message")]
                let _ = ranks.gather_messages(None::<PhysicsFailure>);
                #[expect(clippy::let_underscore_must_use, reason = "a rank that has ended needs no message")]
                let _ = ranks.broadcast_message(Some(None::<RankOrder>));
                return Err(failure);
            }
        };
        // Dropped if a rank has failed, which ends the others.
        let ranked = FirstRank {
            worker,
            _threads: threads,
            crossed: vec![],
            is_to_migrate: false,
            shared_cells: 0,
            named: vec![],
            stopped: OnceCell::new(),
        };
        let begun = ranked.worker.ranks().gather_messages(None::<PhysicsFailure>);
        let begun = begun.map_err(|lost| ranked.record_loss(lost))?;
        first_of(begun).map(|()| ranked)
    }
}

impl FirstRank {
    fn engine(&self) -> &dyn SteppingDiscs {
        self.worker.engine()
    }

    fn broadcast_order(&self, order: &RankOrder) -> Result<(), RankError> {
        self.worker.ranks().broadcast(Some(Parcel::of(&Some(order)))).map(drop)
    }

    /// Makes all ranks execute an order that changes something; returns their answers.
    fn order<T: DeserializeOwned>(&mut self, what: Do) -> Result<Vec<T>, PhysicsFailure> {
        self.check_ranks()?;
        let crossed = std::mem::take(&mut self.crossed);
        let order = RankOrder { crossed, is_to_migrate: std::mem::take(&mut self.is_to_migrate), what };
        let answered = self.broadcast_order(&order).and_then(|()| self.worker.execute_order(order));
        let answers = answered.and_then(|own| self.worker.ranks().gather(own));
        answers.and_then(|all| opened(&all)).map_err(|lost| self.record_loss(lost))
    }

    /// Makes all ranks sample something; `found` combines their answers. Returns the default if a rank is lost.
    fn sample_all<R: Default>(
        &self,
        what: RankSample,
        found: impl FnOnce(&[Parcel]) -> Result<R, RankError>,
    ) -> R {
        let look = || {
            self.broadcast_order(&Do::Look(what).into())?;
            found(&self.worker.ranks().gather(self.worker.take_sample(what)?)?)
        };
        if self.stopped.get().is_some() {
            return R::default();
        }
        match look() {
            Ok(found) => found,
            Err(lost) => {
                self.record_loss(lost);
                R::default()
            }
        }
    }

    /// Stores the first loss of a rank as a failure; all others then end, whatever message they wait for.
    fn record_loss(&self, lost: RankError) -> PhysicsFailure {
        self.stop(&Parcel::lost(RankError::Ended(0)), || rank_loss_failure(lost, self.clock()))
    }

    /// Makes the other ranks end for a reason; returns the first reason.
    fn stop(&self, told: &Parcel, why: impl FnOnce() -> PhysicsFailure) -> PhysicsFailure {
        let stop = || {
            #[expect(clippy::let_underscore_must_use, reason = "a rank that has ended needs no message")]
            let _ = self.worker.ranks().broadcast(Some(told.clone()));
            why()
        };
        self.stopped.get_or_init(stop).clone()
    }

    /// Combines the reports of a step; returns the discs that moved far.
    fn combine_reports(&mut self, reports: Vec<StepReport>) -> Result<Vec<u32>, PhysicsFailure> {
        let (mut failures, mut far) = (vec![], vec![]);
        self.shared_cells = 0;
        for (rank, report) in reports.into_iter().enumerate() {
            failures.push(report.failure);
            far.extend(report.far);
            for (number, periods) in report.crossed {
                if rank > 0 {
                    self.worker.engine_mut().elapsed_mut().crossings.add(number, periods);
                }
                self.crossed.push((rank, (number, periods)));
            }
            self.is_to_migrate |= report.has_strayed;
            self.shared_cells += report.shared_cells;
        }
        first_of(failures)?;
        Ok(self.name(far))
    }

    /// Stores discs to be named and returns their indices.
    fn name(&mut self, discs: Vec<DiscRecord>) -> Vec<u32> {
        let mut named = discs.clone();
        named.sort_by_key(|disc| (!disc.is_grain, disc.number));
        named.dedup_by_key(|disc| disc.number);
        let at = |disc: &DiscRecord| {
            named.iter().position(|it| it.number == disc.number).unwrap_or_default() as u32
        };
        let places = discs.iter().map(at).collect();
        self.named = named;
        places
    }

    /// Collects values of each of the scene's discs from its rank; NaN where a rank is lost.
    fn each<const N: usize>(&self, what: RankSample) -> Vec<[f64; N]> {
        let none = || vec![[f64::NAN; N]; self.engine().start().len()];
        let found = |answers: &[Parcel]| {
            let mut all = none();
            answers.iter().enumerate().try_for_each(|(rank, own)| store_rank_values(own, rank, &mut all))?;
            Ok(Some(all))
        };
        self.sample_all(what, found).unwrap_or_else(none)
    }

    /// Position, angle and their rates of each of the scene's discs at the end of the step.
    fn standing(&self) -> Vec<[f64; 6]> {
        self.each(RankSample::Standing)
    }
}

/// Decodes the messages of all ranks.
fn opened<T: DeserializeOwned>(answers: &[Parcel]) -> Result<Vec<T>, RankError> {
    answers.iter().enumerate().map(|(rank, answer)| answer.open(rank)).collect()
}

/// Selects the failure that a single rank would have reported, and adds the rank that it comes from.
fn first_of(failures: Vec<Option<PhysicsFailure>>) -> Result<(), PhysicsFailure> {
    let failures = failures.into_iter().enumerate().filter_map(|(rank, it)| Some((rank, it?)));
    let failures: Vec<(usize, PhysicsFailure)> = failures.collect();
    let first = |failure: &PhysicsFailure| failure.culprits.first().map(|culprit| culprit.id);
    let count = failures.iter().map(|(_, failure)| failure.count).max().unwrap_or(0);
    match failures.into_iter().min_by_key(|(_, failure)| first(failure)) {
        Some((rank, failure)) => {
            let message = format!("{} (rank {rank})", failure.message);
            Err(PhysicsFailure { message, count, ..failure })
        }
        None => Ok(()),
    }
}

impl Drop for FirstRank {
    fn drop(&mut self) {
        self.end();
    }
}

impl NameableDiscs for FirstRank {
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

impl PerParticle for FirstRank {
    fn particles(&self) -> Particles {
        wrapped(self.unwrapped(), &self.engine().domain())
    }

    fn is_whole(&self) -> bool {
        self.stopped.get().is_none()
    }

    fn states(&self, states: &mut GrainStates) {
        let domain = self.engine().domain();
        for (number, [x, y, _, vx, vy, _]) in self.standing().into_iter().enumerate() {
            states.store_state(number, domain.wrapped([x, y]), [vx, vy]);
        }
    }

    fn positions(&self) -> Vec<[f32; 3]> {
        let domain = self.engine().domain();
        let place = |[x, y, ..]: [f64; 6]| domain.wrapped(in_space([x, y])).map(|along| along as f32);
        self.standing().into_iter().map(place).collect()
    }

    fn images(&self) -> Vec<[i32; 2]> {
        let (domain, crossings) = (&self.engine().domain(), &self.engine().elapsed().crossings);
        if !crossings.follows(domain) {
            return vec![];
        }
        let image = |(number, [x, y, ..]): (usize, [f64; 6])| crossings.image(domain, number, [x, y]);
        self.standing().into_iter().enumerate().map(image).collect()
    }
}

impl SteppingDiscs for FirstRank {
    fn advance(&mut self) -> Result<Vec<u32>, PhysicsFailure> {
        let reports = self.order(Do::Advance)?;
        self.combine_reports(reports)
    }

    fn compute_forces(&mut self, asked: ObservationRequest) -> Result<SweepReport, PhysicsFailure> {
        let reports: Vec<ForcesReport> = self.order(Do::Forces(asked))?;
        let (mut failures, mut deep, mut of_bands) = (vec![], vec![], vec![]);
        for report in reports {
            refuse(report.distributed, self.clock())?;
            failures.push(report.failure);
            of_bands.extend(report.bands);
            deep.extend(report.deep);
        }
        first_of(failures)?;
        let deep = self.name(deep.concat()).chunks_exact(2).map(|pair| [pair[0], pair[1]]).collect();
        Ok(SweepReport { deep, ..SweepReport::from_bands(of_bands) })
    }

    fn end(&mut self) {
        let what = "this simulation has already been ended on all ranks";
        let why = || PhysicsFailure::new(FailureKind::MACHINE, what, "report this with the scene");
        self.stop(&Parcel::of(&None::<RankOrder>), why);
    }

    fn elapsed(&self) -> &Elapsed {
        self.engine().elapsed()
    }

    fn elapsed_mut(&mut self) -> &mut Elapsed {
        self.worker.engine_mut().elapsed_mut()
    }

    fn start(&self) -> &Particles {
        self.engine().start()
    }

    fn shared_cells(&self) -> usize {
        self.shared_cells
    }

    fn lists(&self) -> Option<(usize, u64)> {
        let (_, made) = self.engine().lists()?;
        let listed: Vec<usize> = self.sample_all(RankSample::Listed, opened);
        Some((listed.into_iter().sum(), made))
    }

    fn unwrapped(&self) -> Particles {
        let mut particles = self.engine().start().clone();
        let grains = particles.grain_count();
        let walls = in_space(self.worker.prescribed().unwrap_or_default().velocity);
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
        self.each(RankSample::Forces)
    }

    fn check_ranks(&self) -> Result<(), PhysicsFailure> {
        self.stopped.get().map_or(Ok(()), |failure| Err(failure.clone()))
    }

    fn columns(&self) -> Vec<(String, CheckpointColumn)> {
        let [of_each, of_all] = self.worker.columns();
        let columns = of_each.into_iter().enumerate().map(|(place, (name, like))| {
            let values = self.each(RankSample::Column(place)).into_iter().map(|[value]| value).collect();
            (name, column_like(&like, values))
        });
        columns.chain(of_all).collect()
    }

    fn restore(&mut self, steps: u64, columns: &[(String, CheckpointColumn)]) -> Result<(), String> {
        self.is_to_migrate = false;
        let answers = self.order::<Result<(), String>>(Do::Restore { steps, columns: columns.to_vec() });
        answers.map_err(|failure| failure.what_and_when())?.into_iter().collect()
    }

    fn sums(&self, scenery: &SceneProperties, work: &GravityWork<'_>) -> ObservationSums {
        let standing = self.standing();
        let grains = sums_of_grains(self.engine().start().grains(), (scenery, work), |number| {
            let [x, y, _, vx, vy, omega] = standing[number];
            StepEndDisc { position: [x, y], velocity: [vx, vy], omega }
        });
        let met = SweepReport::from_bands(
            self.sample_all(RankSample::Contacts, opened::<Vec<BandReport>>).concat(),
        );
        ObservationSums { grains, contacts: contact_sums(&met) }
    }
}

impl RemovableDiscs for FirstRank {
    fn predicted_velocities(&self) -> Vec<[f64; 2]> {
        self.each(RankSample::Velocities)
    }

    fn skip_forces(&mut self) -> Result<(), PhysicsFailure> {
        let answers: Vec<Result<(), String>> = self.order(Do::SkipForces)?;
        answers.into_iter().try_for_each(|distributed| refuse(distributed, self.clock()))
    }

    fn unfit(&self) -> Vec<usize> {
        let mut unfit = self.sample_all(RankSample::Unfit, opened::<Vec<usize>>).concat();
        unfit.sort_unstable();
        unfit
    }

    fn settle(&mut self) -> Result<(), PhysicsFailure> {
        let reports = self.order(Do::Settle)?;
        self.is_to_migrate = true;
        self.combine_reports(reports).map(drop)
    }
}

/// Failure of a redistribution of discs.
fn refuse(distributed: Result<(), String>, at: Clock) -> Result<(), PhysicsFailure> {
    distributed.map_err(|why| {
        let what = format!("discs cannot be distributed to the ranks: {why}");
        PhysicsFailure::new(FailureKind::MACHINE, what, "report this with the scene").at(at)
    })
}
