//! Units, signs, tables, help of errors.
