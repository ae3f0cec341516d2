//! Classes that pickle and copy rebuild from their attributes.

/// Defines a class with read-only attributes, the ordered list of their names, and the function that rebuilds an object.
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
            /// Names of the attributes, in pickle's order.
            pub(crate) const ATTRIBUTES: &[&str] = &[$(stringify!($name)),*];
        }

        /// Rebuilds an object from its attributes, for pickle.
        #[pyfunction]
        #[pyo3(signature = ($($name),*))]
        #[allow(clippy::too_many_arguments, reason = "one for each attribute")]
        pub(crate) fn $again($($name: $kind),*) -> $class {
            $class { $($name),* }
        }
    };
}

pub(crate) use class_of_attributes;
