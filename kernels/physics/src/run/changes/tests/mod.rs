//! Tests of the log, of changed simulations against exact motion, and of resumed runs to the bit.

mod motion;
mod resumption;

use super::*;
use crate::method::{METHODS, Prepared, Simulation, StartPurpose, load};
use std::sync::atomic::AtomicBool;

static NEVER: AtomicBool = AtomicBool::new(false);

fn prepared(preset: &str, overrides: &[&str]) -> Prepared {
    let overrides: Vec<String> = overrides.iter().map(|&text| text.to_owned()).collect();
    load(preset, &overrides, METHODS).unwrap().0
}

fn started(preset: &str, overrides: &[&str]) -> Box<dyn Simulation> {
    prepared(preset, overrides).start(StartPurpose::Run).unwrap()
}

fn change(quantity: SteeredQuantity, values: &[f64]) -> Change {
    Change { quantity, values: values.to_vec() }
}

fn advance(simulation: &mut dyn Simulation, until: Until) {
    simulation.advance(&[until], &NEVER).unwrap();
}

const GRAVITY: SteeredQuantity = SteeredQuantity::Gravity;
const VELOCITIES: SteeredQuantity = SteeredQuantity::Velocities;
const BATH: SteeredQuantity = SteeredQuantity::BathTemperature;
const WALL_VELOCITIES: SteeredQuantity = SteeredQuantity::WallVelocities;

fn at(steps: u64) -> Clock {
    Clock { steps, time: 0.1 * steps as f64, events: 0 }
}

/// Values keep their bits; a line that was cut off is no change.
#[test]
fn logged_changes_keep_their_bits() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(CHANGES);
    let gravity = Change { quantity: SteeredQuantity::Gravity, values: vec![-0.0, 0.1 + 0.2] };
    let bath = Change { quantity: SteeredQuantity::BathTemperature, values: vec![5e-324] };
    let mut log = ChangeLog::begin(path.clone());
    log.append(&at(3), &gravity).unwrap();
    log.append(&at(7), &bath).unwrap();
    let text = std::fs::read_to_string(&path).unwrap();
    let expected =
        "step,time,events,quantity,values\n3,0.30000000000000004,0,gravity,-0.0 0.30000000000000004\n";
    assert!(text.starts_with(expected), "{text}");
    std::fs::write(&path, format!("{text}9,0.9,0,gravity,0.0 -1")).unwrap();
    let mut log = ChangeLog::resume(path.clone(), 0).unwrap();
    assert_eq!(std::fs::read_to_string(&path).unwrap(), text);
    assert_eq!((log.next_moment(&at(0)), log.last_pending()), (Some(Until::Steps(3)), Some(at(7))));
    assert_eq!(log.take_due(&at(2)), None);
    let bits = |change: &Change| change.values.iter().map(|it| it.to_bits()).collect::<Vec<_>>();
    assert_eq!(log.take_due(&at(3)).as_ref().map(bits), Some(bits(&gravity)));
    assert_eq!(log.take_due(&at(3)), None);
    assert_eq!(log.take_due(&at(7)), Some(bath));
    assert_eq!(ChangeLog::resume(path.clone(), 1).unwrap().next_moment(&at(5)), Some(Until::Steps(7)));
    assert!(ChangeLog::resume(path.clone(), 3).unwrap_err().to_string().contains("3 changes"));
    for wrong in
        ["3,0.3,0,gravity", "3,0.3,0,mass,1.0", "3,0.3,0,gravity,NaN 0.0", "-3,0.3,0,gravity,0.0 0.0"]
    {
        std::fs::write(&path, format!("{HEADING}{wrong}\n")).unwrap();
        let error = ChangeLog::resume(path.clone(), 0).unwrap_err().to_string();
        assert!(error.contains("line 2"), "{error}");
    }
}
