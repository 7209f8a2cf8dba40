//! What is rendered: camera, film, media, lights; the native TOML scene file.
