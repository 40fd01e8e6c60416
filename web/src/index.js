// Octalux for three.js: fields that `octalux bake` made light standard materials in WebGL2.
//
// SPDX-License-Identifier: MIT
export { FieldError, parseField } from './field_file.js';
export { OctaluxField } from './octalux_field.js';
