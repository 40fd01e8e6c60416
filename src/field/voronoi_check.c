// Checks the chunk that holds the Voronoi selector: its size when a field is opened, and the k-d tree and every texel's
// neighbours when it is verified.
#include "core/hooks.h"
#include "core/result.h"
#include "field/selector_data.h"

olx_result olx_voronoi_check(const olx_field *field) {
  const olx_voronoi_header *header = field->select_data[OLX_SELECT_VORONOI];
  const size_t size_bytes = field->select_bytes[OLX_SELECT_VORONOI];
  const uint32_t probes = field->info.probes.count;
  OLX_TRY(olx_coded_probes_check(probes, "VORO", field->name));
  if (size_bytes < sizeof *header) return olx_fail(OLX_ERROR_FORMAT, "%s: chunk VORO: no header", field->name);
  const uint32_t size = header->size;
  if (size < 4 || size > 64 || (size & (size - 1)) != 0 || header->zero[0] || header->zero[1] || header->zero[2]) {
    return olx_fail(OLX_ERROR_FORMAT, "%s: chunk VORO: maps of %u texels a side, or reserved bytes", field->name, size);
  }
  const uint64_t codes = (uint64_t)probes * size * size * OLX_CHOICES + probes;
  if (size_bytes != sizeof *header + codes * olx_probe_code_bytes(probes)) {
    return olx_fail(OLX_ERROR_FORMAT, "%s: chunk VORO: %zu bytes do not hold %u maps of %u texels a side", field->name,
                    size_bytes, probes, size);
  }
  return OLX_OK;
}

bool olx_choices_are_sound(const uint32_t choices[OLX_CHOICES], uint32_t probe_count) {
  for (uint32_t i = 0; i < OLX_CHOICES; i++) {
    if (choices[i] == OLX_NO_PROBE) continue;
    if (choices[i] >= probe_count) return false;
    for (uint32_t k = 0; k < i; k++) {
      if (choices[k] == choices[i] || choices[k] == OLX_NO_PROBE) return false;
    }
  }
  return true;
}

// Checks that the probes from begin to end - 1 of the tree are split by the middle one.
static bool is_split(const olx_field *field, const uint32_t *order, uint32_t begin, uint32_t end, uint32_t axis) {
  if (end - begin < 2) return true;
  const uint32_t middle = olx_middle(begin, end), next = (axis + 1) % 3;
  const float at = olx_component(field->probe_positions[order[middle]], axis);
  for (uint32_t i = begin; i < end; i++) {
    const float x = olx_component(field->probe_positions[order[i]], axis);
    if (i < middle ? x > at : x < at) return false;
  }
  return is_split(field, order, begin, middle, next) && is_split(field, order, middle + 1, end, next);
}

static olx_result verify_tree(const olx_field *field) {
  const uint32_t count = field->info.probes.count, code_bytes = olx_probe_code_bytes(count);
  uint32_t *order = olx_allocate(count, sizeof *order);
  uint8_t *known = olx_allocate_zero(count, 1);
  olx_result result = OLX_OK;
  if (!order || !known) result = olx_fail(OLX_ERROR_MEMORY, "%s: out of memory for %u probes", field->name, count);
  for (uint32_t i = 0; i < count && result == OLX_OK; i++) {
    order[i] = olx_probe_code(olx_voronoi_codes(field), code_bytes, olx_voronoi_tree(field) + i);
    if (order[i] >= count || known[order[i]]++) {
      result = olx_fail(OLX_ERROR_FORMAT, "%s: chunk VORO: the tree's entry %u is no probe, or one again (%u)",
                        field->name, i, order[i]);
    }
  }
  if (result == OLX_OK && !is_split(field, order, 0, count, 0)) {
    result = olx_fail(OLX_ERROR_FORMAT, "%s: chunk VORO: the tree's order is not that of the positions", field->name);
  }
  olx_release(order);
  olx_release(known);
  return result;
}

olx_result olx_voronoi_verify(const olx_field *field) {
  const olx_voronoi_header *header = field->select_data[OLX_SELECT_VORONOI];
  const uint32_t probes = field->info.probes.count, texels = header->size * header->size;
  const uint32_t code_bytes = olx_probe_code_bytes(probes);
  for (size_t i = 0; i < (size_t)probes * texels; i++) {
    const uint32_t probe = (uint32_t)(i / texels);
    uint32_t choices[OLX_CHOICES];
    bool itself = false;
    for (uint32_t k = 0; k < OLX_CHOICES; k++) {
      choices[k] = olx_probe_code(header + 1, code_bytes, i * OLX_CHOICES + k);
      itself |= choices[k] == probe;
    }
    if (itself || !olx_choices_are_sound(choices, probes)) {
      return olx_fail(OLX_ERROR_FORMAT, "%s: chunk VORO: probe %u, texel %u: not its neighbours (%u %u %u %u)",
                      field->name, probe, (uint32_t)(i % texels), choices[0], choices[1], choices[2], choices[3]);
    }
  }
  return verify_tree(field);
}
