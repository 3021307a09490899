//! `.enf`, the file of a compiled scene: written at once, opened by memory map or from bytes, checked, not copied.
//! `docs/FORMAT.md` specifies it.

mod atomic;
mod container;
mod kind;
pub mod map;
mod packed;
mod pages;
mod prisms;
pub mod records;
mod storage;
mod tables;

pub use atomic::write_atomically;
pub use container::{ALIGN, MAGIC, SectionEntry, VERSION};
pub use kind::FaceKind;
pub use pages::Pages;
pub(crate) use pages::pages_read;
pub(crate) use storage::{Storage, View};
#[cfg(feature = "compile")]
pub(crate) use tables::MapViews;
pub(crate) use tables::Views;
pub(crate) use tables::{MAX_DEPTH, WHOLE_BIT};
pub use tables::{MapTables, Tables};

/// The bytes are no compiled scene that this version can use.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum FormatError {
    /// The first bytes are others.
    #[error("not an enfilade scene (.enf)")]
    Magic,
    /// Another version.
    #[error("version {found} of the format; this program reads version {known}: compile the model again")]
    Version {
        /// In the file.
        found: u32,
        /// Of this reader.
        known: u32,
    },
    /// Written with swapped bytes.
    #[error("written on a machine of the other byte order")]
    Endianness,
    /// This machine is not little-endian.
    #[error("scenes can be opened on little-endian machines only")]
    BigEndianMachine,
    /// Needs features that this version lacks.
    #[error("needs features that this version does not know (bits {0:#x})")]
    Features(u64),
    /// The file was cut, or something was added.
    #[error("{has} bytes long where {needs} were written: cut or damaged")]
    TooShort {
        /// As the header says.
        needs: u64,
        /// As it is.
        has: u64,
    },
    /// The section table contradicts itself.
    #[error("section table: {0}")]
    Table(String),
    /// Bytes differ from those that were written.
    #[error("checksum of {0} is wrong: damaged")]
    Checksum(String),
    /// A section that every scene has is missing.
    #[error("section '{0}' is missing")]
    Missing(&'static str),
    /// A section that must be understood is not known.
    #[error("section '{0}' is required, and not known to this version")]
    Unknown(String),
    /// An index, a count or a number is out of its range.
    #[error("section '{section}', item {item}: {what}")]
    Invalid {
        /// The section.
        section: &'static str,
        /// The item.
        item: u64,
        /// What is wrong.
        what: String,
    },
}
