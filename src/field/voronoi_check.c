#include "core/result.h"
#include "field/selector_data.h"

olx_result olx_voronoi_check(const olx_field *field) {
  const olx_voronoi_header *header = field->select_data[OLX_SELECT_VORONOI];
  const size_t size_bytes = field->select_bytes[OLX_SELECT_VORONOI];
  const uint32_t probes = field->info.probe_count;
  if (probes > OLX_MAX_CODED_PROBES) {
    return olx_fail(OLX_ERROR_FORMAT, "%s: chunk VORO: for at most %d probes, not %u", field->name,
                    OLX_MAX_CODED_PROBES, probes);
  }
  if (size_bytes < sizeof *header) return olx_fail(OLX_ERROR_FORMAT, "%s: chunk VORO: no header", field->name);
  const uint32_t size = header->size;
  if (size < 4 || size > 64 || (size & (size - 1)) != 0 || header->zero[0] || header->zero[1] || header->zero[2]) {
    return olx_fail(OLX_ERROR_FORMAT, "%s: chunk VORO: maps of %u texels a side, or reserved bytes", field->name, size);
  }
  const uint64_t codes = (uint64_t)probes * size * size * OLX_CHOICES;
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

olx_result olx_voronoi_verify(const olx_field *field) {
  const olx_voronoi_header *header = field->select_data[OLX_SELECT_VORONOI];
  const uint32_t probes = field->info.probe_count, texels = header->size * header->size;
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
  return OLX_OK;
}
