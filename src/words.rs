//! Enumerations whose variants are words of scene files and of the command line: variant, word and meaning stated once.

/// A closed set of words.
pub trait Words: Copy + PartialEq + 'static {
    /// Every variant with its word, in the order in which they are offered.
    const ALL: &'static [(Self, &'static str)];
    /// The words alone.
    const WORDS: &'static [&'static str];

    /// The word.
    fn word(self) -> &'static str {
        Self::ALL.iter().find(|(variant, _)| *variant == self).map_or("", |(_, word)| word)
    }

    /// The variant of a word.
    fn parse(word: &str) -> Option<Self> {
        Self::ALL.iter().find(|(_, known)| *known == word).map(|(variant, _)| *variant)
    }
}

/// Words for an enumeration that is defined elsewhere.
macro_rules! words_for {
    ($name:ty { $($variant:ident = $word:literal,)* }) => {
        impl $crate::words::Words for $name {
            const ALL: &'static [(Self, &'static str)] = &[$((Self::$variant, $word)),*];
            const WORDS: &'static [&'static str] = &[$($word),*];
        }
    };
}

/// Defines an enumeration with its words; the first variant is the default.
macro_rules! define_words {
    (
        $(#[$meta:meta])* $vis:vis enum $name:ident {
            $(#[$first_doc:meta])* $first:ident = $first_word:literal,
            $($(#[$doc:meta])* $variant:ident = $word:literal,)*
        }
    ) => {
        $(#[$meta])*
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
        $vis enum $name {
            $(#[$first_doc])* #[default] $first,
            $($(#[$doc])* $variant,)*
        }

        $crate::words::words_for!($name { $first = $first_word, $($variant = $word,)* });
    };
}

pub(crate) use {define_words, words_for};
