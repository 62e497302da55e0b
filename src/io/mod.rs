//! Files in and out; sees only the containers.
