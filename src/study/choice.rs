//! Configuration of a scene: a setting for each axis of its method.

use stripmine_physics::method::{AxisSetting, ChoiceEffect, Prepared, SettingAxis};
use stripmine_physics::scene::Overrides;

/// Largest ratio of the times of two configurations that tie.
pub(crate) const TIE: f64 = 1.1;

/// A setting for each axis.
#[derive(Clone, Debug)]
pub(crate) struct SettingChoice(Vec<(&'static SettingAxis, &'static AxisSetting)>);

impl PartialEq for SettingChoice {
    fn eq(&self, other: &Self) -> bool {
        self.label() == other.label()
    }
}

impl SettingChoice {
    /// Every combination of settings, the first axis changing slowest.
    pub(crate) fn all(axes: &'static [SettingAxis]) -> Vec<SettingChoice> {
        let begin = vec![SettingChoice(vec![])];
        axes.iter().fold(begin, |choices, axis| {
            let with_axis = |choice: SettingChoice| {
                axis.settings.iter().map(move |setting| {
                    SettingChoice(choice.0.iter().copied().chain([(axis, setting)]).collect())
                })
            };
            choices.into_iter().flat_map(with_axis).collect()
        })
    }

    /// The scene's own configuration; the first setting of an axis that does not list the scene's own.
    pub(crate) fn own(axes: &'static [SettingAxis], prepared: &Prepared) -> SettingChoice {
        let of = |axis: &'static SettingAxis| {
            let own = (axis.own)(prepared).and_then(|name| axis.setting(&name));
            Some((axis, own.or(axis.settings.first())?))
        };
        SettingChoice(axes.iter().filter_map(of).collect())
    }

    /// Replaces some settings, by axis and name.
    #[must_use]
    pub(crate) fn with(&self, settings: &[(&str, &str)]) -> SettingChoice {
        let mut changed = self.clone();
        for (axis, setting) in &mut changed.0 {
            let named = settings.iter().find(|(name, _)| *name == axis.name);
            *setting = named.and_then(|(_, name)| axis.setting(name)).unwrap_or(setting);
        }
        changed
    }

    /// Label of the configuration: names of its settings.
    pub(crate) fn label(&self) -> String {
        self.0.iter().map(|(_, setting)| setting.name).collect::<Vec<_>>().join(" ")
    }

    /// Settings with the names of their axes.
    pub(crate) fn settings(&self) -> impl Iterator<Item = (&'static str, &'static str)> {
        self.0.iter().map(|(axis, setting)| (axis.name, setting.name))
    }

    /// Overrides that select the configuration.
    pub(crate) fn overrides(&self) -> Overrides {
        self.0.iter().fold(Overrides::new(), |made, (_, setting)| made.and(&(setting.overrides)()))
    }

    /// Setting of the axis that decides the order of convergence.
    pub(crate) fn scheme(&self) -> Option<&'static AxisSetting> {
        self.of(ChoiceEffect::Order).next()
    }

    fn of(&self, decides: ChoiceEffect) -> impl Iterator<Item = &'static AxisSetting> {
        self.0.iter().filter(move |(axis, _)| axis.decides == decides).map(|(_, setting)| *setting)
    }

    /// Names of the settings on axes of a kind.
    pub(crate) fn names(&self, decides: ChoiceEffect) -> Vec<&'static str> {
        self.of(decides).map(|setting| setting.name).collect()
    }

    /// True if the settings on axes of a kind equal those of another choice.
    pub(crate) fn agrees_on(&self, other: &SettingChoice, decides: ChoiceEffect) -> bool {
        self.names(decides) == other.names(decides)
    }
}
