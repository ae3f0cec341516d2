//! Theory of the step: growth of errors by the matrix of a step, duration and depth of a contact.

pub(crate) mod contact;
pub(crate) mod limits;
pub(crate) mod step_matrix;
pub(crate) mod trial_contact;
