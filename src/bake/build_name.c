// Names the build by the identifier that the linker gave to the program, or the shared library, that holds this code.
#include "bake/bake_work.h"

#include <link.h>
#include <stdio.h>
#include <string.h>

enum { MOST_ID = 24 }; // most bytes of an identifier that the name includes

static uintptr_t aligned_word(uintptr_t size) { return (size + 3) & ~(uintptr_t)3; }

static void name_id(const uint8_t *id, uint32_t size, olx_build_name *name) {
  for (uint32_t i = 0; i < size && i < MOST_ID; i++) snprintf(name->text + 2 * i, 3, "%02x", id[i]);
}

// Reads a segment of ELF notes, each a header, a name and a description.
static void read_notes(const uint8_t *notes, size_t size, olx_build_name *name) {
  while (size > sizeof(ElfW(Nhdr))) {
    ElfW(Nhdr) header;
    memcpy(&header, notes, sizeof header);
    const uint8_t *owner = notes + sizeof header, *content = owner + aligned_word(header.n_namesz);
    const size_t length = sizeof header + aligned_word(header.n_namesz) + aligned_word(header.n_descsz);
    if (length > size) return;
    if (header.n_type == NT_GNU_BUILD_ID && header.n_namesz == 4 && memcmp(owner, "GNU", 4) == 0)
      name_id(content, header.n_descsz, name);
    notes += length;
    size -= length;
  }
}

static bool holds(const struct dl_phdr_info *object, uintptr_t address) {
  for (int i = 0; i < object->dlpi_phnum; i++) {
    const ElfW(Phdr) *segment = &object->dlpi_phdr[i];
    const uintptr_t first = object->dlpi_addr + segment->p_vaddr;
    if (segment->p_type == PT_LOAD && address >= first && address < first + segment->p_memsz) return true;
  }
  return false;
}

static int look_at(struct dl_phdr_info *object, size_t size, void *user) {
  (void)size;
  olx_build_name *name = user;
  if (!holds(object, (uintptr_t)olx_name_build)) return 0;
  for (int i = 0; i < object->dlpi_phnum; i++) {
    const ElfW(Phdr) *segment = &object->dlpi_phdr[i];
    if (segment->p_type != PT_NOTE) continue;
    read_notes((const uint8_t *)(object->dlpi_addr + segment->p_vaddr), segment->p_memsz, name);
  }
  return 1;
}

// Names the build by the linker's identifier, or by the compiler's and the library's versions where there is none.
olx_build_name olx_name_build(void) {
  olx_build_name name = {""};
  dl_iterate_phdr(look_at, &name);
  if (!*name.text) snprintf(name.text, sizeof name.text, "%s by %.40s", olx_version(), __VERSION__);
  return name;
}
