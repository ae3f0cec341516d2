//! Enumerations whose variants are words of scene files and of the command line. Variant, word and meaning are stated once.

/// Closed set of words.
pub trait Words: Copy + PartialEq + 'static {
    /// Every variant with its word, in the order in which they are offered.
    const ALL: &'static [(Self, &'static str)];
    /// Words alone.
    const WORDS: &'static [&'static str];

    /// Word of this variant.
    fn word(self) -> &'static str {
        Self::ALL.iter().find(|(variant, _)| *variant == self).map_or("", |(_, word)| word)
    }

    /// Variant of a word.
    fn parse(word: &str) -> Option<Self> {
        Self::ALL.iter().find(|(_, known)| *known == word).map(|(variant, _)| *variant)
    }
}

/// Most similar of some names, if any is similar enough to be meant.
pub fn nearest<'a>(name: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    // No name is this long; the comparison takes time in proportion to both lengths.
    if name.len() > 64 {
        return None;
    }
    let distance = |candidate: &str| strsim::damerau_levenshtein(&name.to_lowercase(), candidate);
    let near =
        |candidate: &&str| distance(candidate) <= (candidate.len() / 3).max(2).min((name.len() / 2).max(1));
    candidates.into_iter().filter(near).min_by_key(|candidate| distance(candidate))
}

/// Suggestion of the most similar name as a line of a message; empty if no name is similar.
pub fn suggestion<'a>(name: &str, candidates: impl IntoIterator<Item = &'a str>) -> String {
    nearest(name, candidates).map_or(String::new(), |near| format!("\n  help: did you mean {near}?"))
}

/// Defines words for an enumeration of another module.
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
