//! The window: what the user sees and does. It knows the [`Session`](crate::session::Session) and nothing below it
//! depends on it.
//!
//! | module | what |
//! | --- | --- |
//! | `window` | the native window: adapter, event loop, what is said where there is no display |
//! | `inspector` | one frame: jobs' news, panels, commands; the same in the window, headless and in tests |
//! | `about/` | what there is to know about each choice: two sentences, the equation, the paper |
//! | `actions/` | everything the user may do by name: what menus, keys, palette and scripts read |
//! | `command` | everything a panel can ask for, and the one `match` that carries it out |
//! | `view_state` | what of the view is worth saving: panels, zoom, orbit, toggles |
//! | `document` | session and view as a session file has them |
//! | `history` | undo and redo |
//! | `autosave` | the document kept for the next start |
//! | `light_view` | which light is selected, and its sweep |
//! | `message_log` | sentences for the user, shown once and kept |
//! | `texel_report` | what the selected texel holds, gathered once per change |
//! | `brdf_report` | its effective BRDF, in truth and by methods, worked out in the background |
//! | `error_report` | the error of a method in every texel, likewise |
//! | `disc_textures` | effective BRDFs as pictures |
//! | `built_filters` | what both keep of the methods they have built |
//! | `tour` | the tour of the window |
//! | `trace_report` | how the selected texel's fit went, on demand |
//! | `export_view` | what of exports is worth saving |
//! | `exports` | what the window exports, written in the background |
//! | `figures_report` | the sweeps of the open map, measured and saved in the background |
//! | `figures_plot`, `figures_file` | a sweep as a plot; as CSV, JSON or PNG |
//! | `live_figures` | figures of the methods on show, worked out in the background |
//! | `method_style` | how a method's curve looks in any plot |
//! | `dock` | the panels, docked: where they stand, and which are in sight |
//! | `dolly` | the camera that runs away and back |
//! | `settings` | what the user prefers, whatever session is open |
//! | `surface_picture` | the lit surface as a picture, with its settings below it |
//! | `map_picture`, `level_colors`, `level_places` | levels as pictures; their colours; where they stand |
//! | `level_histogram` | how a level's numbers are spread |
//! | `map_shading`, `texel_values`, `texel_scale` | what they show of texels, the values, the colours |
//! | `viewport` | the bridge to the GPU: paint callbacks of surface and sphere |
//! | `parameter` | sliders built from a parameter's description |
//! | `theme` | three themes: colours, spacing, type |
//! | `panels/` | one file per panel: reads state, pushes commands |

pub mod about;
pub mod actions;
pub mod autosave;
pub mod brdf_report;
pub mod built_filters;
pub mod command;
pub mod disc_textures;
pub mod dock;
pub mod document;
pub mod dolly;
pub mod drying_view;
pub mod error_report;
pub mod export_view;
pub mod exports;
pub mod figures_file;
pub mod figures_plot;
pub mod figures_report;
pub mod history;
pub mod inspector;
pub mod level_colors;
pub mod level_histogram;
pub mod level_places;
pub mod light_view;
pub mod live_figures;
pub mod map_picture;
pub mod map_shading;
pub mod message_log;
pub mod method_style;
pub mod panels;
pub mod parameter;
pub mod settings;
pub mod surface_picture;
pub mod texel_report;
pub mod texel_scale;
pub mod texel_values;
pub mod theme;
pub mod tour;
pub mod trace_report;
pub mod view_state;
pub mod viewport;
pub mod window;

pub use command::Command;
pub use inspector::Inspector;
pub use view_state::ViewState;
