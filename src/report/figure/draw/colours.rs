//! Numbers as colours.

use super::super::{Axis, Fault, Scale, style};
use super::axis::{ends, linear};
use kuva::prelude::TickFormat;
use kuva::render::color::Color;
use std::fmt::Write;
use std::sync::Arc;

/// Which way a colour bar goes from its lowest to its highest shade.
#[derive(Clone, Copy)]
pub enum Way {
    /// To the right.
    Right,
    /// Up.
    Up,
}

/// A colour bar's filling, and its definition, which has the same name in every picture.
pub struct Filling {
    /// What names it.
    pub fill: Color,
    /// What it is.
    pub definition: String,
}

/// All shades of magnitudes, or of signed quantities.
pub fn shades(signed: bool, way: Way) -> Filling {
    const STOPS: u8 = 16;
    let (name, ends) = match way {
        Way::Right => (format!("shades{}", u8::from(signed)), ""),
        Way::Up => (format!("shades{}-up", u8::from(signed)), " x2=\"0\" y1=\"1\""),
    };
    let mut definition = format!("<linearGradient id=\"{name}\"{ends}>");
    for stop in 0..=STOPS {
        let place = f64::from(stop) / f64::from(STOPS);
        let shade = style::shade(style::level(place, signed));
        let _ = write!(definition, "<stop offset=\"{place}\" stop-color=\"{shade}\"/>");
    }
    definition.push_str("</linearGradient>");
    Filling { fill: Color::Css(format!("url(#{name})").into()), definition }
}

/// A range of numbers and the colours that stand for them.
#[derive(Clone, Debug)]
pub struct Shades {
    scale: Scale,
    /// Lowest and highest number, or their logarithms.
    pub ends: [f64; 2],
}

impl Shades {
    /// For the values of a map: exactly theirs where the axis does not say.
    ///
    /// # Errors
    /// [`Fault`] if there are no values.
    pub fn new(axis: &Axis, values: impl Iterator<Item = f64>) -> Result<Shades, Fault> {
        let [low, high] = values
            .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| [low.min(value), high.max(value)]);
        let exact = axis.limits.is_none() && low < high;
        let ends = if exact { [low, high] } else { ends(axis, [low, high].into_iter())? };
        let measured = |end| if axis.scale == Scale::Linear { end } else { libm::log10(end) };
        Ok(Shades { scale: axis.scale, ends: ends.map(measured) })
    }

    /// Whether they show a sign.
    pub fn signed(&self) -> bool {
        self.scale == Scale::Linear && style::is_signed(self.ends)
    }

    /// The level of a value.
    pub fn level(&self, value: f64) -> u8 {
        let measured = if self.scale == Scale::Linear { value } else { libm::log10(value) };
        style::level((measured - self.ends[0]) / (self.ends[1] - self.ends[0]), self.signed())
    }

    /// The value in the middle of those of a level.
    pub fn value(&self, level: u8) -> f64 {
        let signed = self.signed();
        let place = f64::from(level - style::levels(signed).start()) / f64::from(style::SHADES - 1);
        let measured = self.ends[0] + place * (self.ends[1] - self.ends[0]);
        if self.scale == Scale::Linear { measured } else { libm::pow(10.0, measured) }
    }

    /// How numbers are written along the colours.
    pub fn format(&self) -> TickFormat {
        match self.scale {
            Scale::Linear => linear(self.ends),
            Scale::Logarithmic => {
                let spelled = linear([1.0, 10.0]);
                TickFormat::Custom(Arc::new(move |power| {
                    let number = libm::pow(10.0, power);
                    let digits = libm::pow(10.0, (1.0 - power.floor()).max(0.0));
                    spelled.format((number * digits).round() / digits)
                }))
            }
        }
    }
}
