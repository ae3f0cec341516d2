//! Classes that pickle and copy make again from their attributes.

/// Defines a class of attributes that cannot change, their names in order, and the function that makes an object of them.
macro_rules! class_of_attributes {
    (
        $(#[$about:meta])*
        $class:ident, made again by $again:ident {
            $($(#[$doc:meta])* $name:ident: $kind:ty,)*
        }
    ) => {
        $(#[$about])*
        #[pyclass(frozen, get_all, module = "stripmine")]
        pub(crate) struct $class {
            $($(#[$doc])* $name: $kind,)*
        }

        impl $class {
            /// The attributes, in the order in which pickle hands them over.
            pub(crate) const ATTRIBUTES: &[&str] = &[$(stringify!($name)),*];
        }

        /// An object of these attributes, as pickle hands them over.
        #[pyfunction]
        #[pyo3(signature = ($($name),*))]
        #[allow(clippy::too_many_arguments, reason = "one for each attribute")]
        pub(crate) fn $again($($name: $kind),*) -> $class {
            $class { $($name),* }
        }
    };
}

pub(crate) use class_of_attributes;
