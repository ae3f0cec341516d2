//! What theory says of the step: growth of errors by the matrix of a step, the duration and depth of a contact.

pub mod contact;
pub mod limits;
pub mod step_matrix;
pub mod trial_contact;
