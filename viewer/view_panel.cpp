// Draws the panel over the image, controls for the state and the times of passes, with Dear ImGui.
#include <GLFW/glfw3.h>
#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_vulkan.h>
#include <imgui.h>

#include "view_panel.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <new>
#include <unistd.h>

struct view_panel {
  VkDevice device;
  VkDescriptorPool pool;
  ImGuiContext *context;
  bool has_window, has_backend;
};

namespace {

// Width in heights of a letter, and its bound as a share of the window.
const float WIDTH = 19.0f, MOST_OF_WINDOW = 0.36f;
// Height of letters in pixels, on displays without scaling.
const float LETTER = 15.0f;

// Reports errors of Vulkan, which the backend would otherwise ignore.
void refuse(VkResult result) {
  if (result < 0) throw result;
}

void set_style() {
  ImGui::StyleColorsDark();
  ImGuiStyle &style = ImGui::GetStyle();
  style.WindowRounding = 6.0f;
  style.FrameRounding = 3.0f;
  style.GrabRounding = 3.0f;
  style.WindowBorderSize = 0.0f;
  style.Colors[ImGuiCol_WindowBg] = ImVec4(0.07f, 0.08f, 0.09f, 0.90f);
  style.Colors[ImGuiCol_FrameBg] = ImVec4(0.19f, 0.21f, 0.24f, 1.0f);
  style.Colors[ImGuiCol_Header] = ImVec4(0.22f, 0.26f, 0.32f, 1.0f);
  style.Colors[ImGuiCol_CheckMark] = style.Colors[ImGuiCol_SliderGrab] = ImVec4(1.0f, 0.72f, 0.35f, 1.0f);
  style.Colors[ImGuiCol_PlotLines] = ImVec4(1.0f, 0.72f, 0.35f, 1.0f);
}

// Shows an explanation of the last widget while the mouse is over it.
void explain(const char *text) {
  if (!ImGui::IsItemHovered()) return;
  ImGui::BeginTooltip();
  ImGui::PushTextWrapPos(22.0f * ImGui::GetFontSize());
  ImGui::TextUnformatted(text);
  ImGui::PopTextWrapPos();
  ImGui::EndTooltip();
}

// A choice among the words of a list. `allowed` has a bit for each word that can be chosen.
bool choose(const char *label, const char *words, uint32_t allowed, uint32_t *value) {
  char word[64];
  bool changed = false;
  view_word(words, *value, word, sizeof word);
  if (!ImGui::BeginCombo(label, word)) return false;
  for (uint32_t i = 0; view_word(words, i, word, sizeof word), word[0]; i++) {
    if (!(allowed >> i & 1u) || !ImGui::Selectable(word, i == *value)) continue;
    *value = i;
    changed = true;
  }
  ImGui::EndCombo();
  return changed;
}

void build_light(view_state *s) {
  ImGui::Checkbox("direct", &s->direct);
  explain("Light straight from lamps, the sun and the sky. The rasteriser computes it. Key R.");
  ImGui::SameLine();
  ImGui::Checkbox("diffuse", &s->diffuse);
  explain("Light that surfaces reflected at least once and that matte surfaces receive, read from the field. Key F.");
  ImGui::SameLine();
  ImGui::Checkbox("glossy", &s->glossy);
  explain("Reflections, traced through the probes. Key G.");
  if (ImGui::SliderFloat("exposure", &s->exposure, 0.01f, 100.0f, "%.2f", ImGuiSliderFlags_Logarithmic))
    s->auto_exposure = false;
  explain("A factor of light before it is shown. Keys - and =.");
  ImGui::Checkbox("follows the picture", &s->auto_exposure);
  explain("The exposure follows how bright the picture is, as an eye does. Key J.");
  ImGui::SliderFloat("resolution", &s->scale, 0.125f, 1.0f, "%.3f");
  explain("Pixels that are lit, along a side, over those that are shown: less is faster. Keys [ and ].");
}

void build_research(const view_facts *facts, view_state *s) {
  choose("mode", VIEW_MODE_WORDS, ~0u, &s->mode);
  explain("How indirect light is made: as it is stored, one ray a pixel denoised, rays that add up over frames, or eye "
          "rays through the field alone. "
          "Keys 1 to 4.");
  choose("tracer", VIEW_TRACER_WORDS, ~0u, &s->tracer);
  explain("How rays march through a probe's map. Key T.");
  const uint32_t stored = facts->field.irradiance.probe_count ? 1u << OLX_HITS_STORED : 0u;
  choose("hits", VIEW_HITS_WORDS, 1u << OLX_HITS_SHADED | stored, &s->hits);
  explain("Light where a ray ends: of the surface there, or as a probe saw it.");
  const uint32_t baked =
      facts->field.select_mask & (1u << OLX_SELECT_CAGE | 1u << OLX_SELECT_BRICKS | 1u << OLX_SELECT_VORONOI);
  choose("selector", VIEW_SELECT_WORDS, baked | 1u << OLX_SELECT_EXHAUSTIVE | 1u << OLX_SELECT_BEST, &s->select);
  explain("Which probes a ray queries. Key B.");
  if (s->mode == VIEW_GATHER) {
    int samples = static_cast<int>(s->gather_samples);
    if (ImGui::SliderInt("rays a frame", &samples, 1, 64))
      s->gather_samples = static_cast<uint32_t>(std::max(samples, 1));
  } else if (s->mode != VIEW_PROBES) {
    choose("denoiser", VIEW_DENOISE_WORDS, ~0u, &s->denoise);
    explain("How rays are filtered over pixels and frames.");
  }
  if (s->mode == VIEW_DENOISED || s->mode == VIEW_GATHER) {
    ImGui::Checkbox("emitters met by rays", &s->emitters);
    explain("Lamps with an area are found by rays instead of by direct light. Key L.");
  }
  ImGui::Checkbox("visibility", &s->visibility);
  explain("Irradiance probes that do not see a point are left out. Key V.");
  ImGui::SameLine();
  ImGui::Checkbox("buried probes", &s->keep_buried);
  explain("Probes inside geometry are queried as well.");
  ImGui::SliderFloat("dim lobes", &s->dim_lobe, 0.0f, 0.5f, "%.2f");
  explain("Rough lobes that reflect less than this share are not traced.");
}

// Edits the position of the sun in the sky, in degrees, instead of the direction of its light.
void build_sun(olx_light *light) {
  const float degree = 57.2957795f;
  const olx_vec3 d = light->direction;
  float around = std::atan2(-d.x, -d.z) * degree, height = std::asin(std::clamp(-d.y, -1.0f, 1.0f)) * degree;
  bool turned = ImGui::SliderFloat("around", &around, -180.0f, 180.0f, "%.1f deg");
  turned |= ImGui::SliderFloat("height", &height, -89.0f, 89.0f, "%.1f deg");
  if (!turned) return;
  around /= degree;
  height /= degree;
  light->direction = {-std::cos(height) * std::sin(around), -std::sin(height), -std::cos(height) * std::cos(around)};
}

void build_lights(const view_relight_times *relight, view_state *s) {
  static const char *const kinds[] = {"sun", "point", "spot"};
  view_lights *lights = &s->lights;
  for (uint32_t i = 0; i < lights->count; i++) {
    ImGui::PushID(static_cast<int>(i));
    olx_light *light = &lights->light[i];
    bool chosen = s->light == i;
    char name[32];
    std::snprintf(name, sizeof name, "%s %u", kinds[light->type], i);
    if (ImGui::Checkbox(name, &chosen)) s->light = chosen ? i : VIEW_NO_LIGHT;
    if (light->type == OLX_LIGHT_SUN) build_sun(light);
    else ImGui::DragFloat3("place", &light->position.x, 0.01f);
    ImGui::SliderFloat("strength", &lights->strength[i], 0.0f, 10.0f, "%.2f", ImGuiSliderFlags_Logarithmic);
    ImGui::PopID();
  }
  if (lights->count) explain("Of what the scene gives this light.");
  if (lights->count) ImGui::TextDisabled("the arrows move what is chosen");
  ImGui::SliderFloat("surfaces", &lights->surfaces, 0.0f, 10.0f, "%.2f", ImGuiSliderFlags_Logarithmic);
  ImGui::SliderFloat("sky", &lights->sky, 0.0f, 10.0f, "%.2f", ImGuiSliderFlags_Logarithmic);
  if (!relight->on) ImGui::TextDisabled("indirect light stays as baked (--relight)");
}

void build_relight(const view_relight_times *t) {
  const int shown = static_cast<int>(std::min<uint32_t>(t->frames, VIEW_HISTORY));
  const int first = static_cast<int>(t->frames > VIEW_HISTORY ? t->frames % VIEW_HISTORY : 0);
  float most = 0.0f;
  for (int i = 0; i < shown; i++) most = std::max(most, t->history[i]);
  ImGui::PlotLines("##relight", t->history, shown, first, nullptr, 0.0f, most * 1.1f, ImVec2(110.0f, 15.0f));
  ImGui::SameLine();
  ImGui::Text("%8.3f  relighting (CPU)", static_cast<double>(t->milliseconds));
  ImGui::TextDisabled("%u parts of the light not settled, %.0f kB copied, %.0f wait", t->awake,
                      static_cast<double>(t->copied_bytes) / 1000.0, static_cast<double>(t->waiting_bytes) / 1000.0);
}

void build_camera(const view_facts *facts, view_state *s, view_camera *camera) {
  if (ImGui::BeginCombo("camera", facts->cameras[s->camera].name)) {
    for (uint32_t i = 0; i < facts->camera_count; i++) {
      ImGui::PushID(static_cast<int>(i));
      if (ImGui::Selectable(facts->cameras[i].name, i == s->camera)) {
        s->camera = i;
        *camera = view_camera_of(&facts->cameras[i]);
      }
      ImGui::PopID();
    }
    ImGui::EndCombo();
  }
  explain("A camera of the scene. Key C: the next one.");
  ImGui::SliderFloat("speed", &s->speed, 0.01f, 100.0f, "%.2f m/s", ImGuiSliderFlags_Logarithmic);
  explain("How fast W, A, S, D, Q and E fly. The wheel changes it, too.");
  ImGui::TextDisabled("%.2f %.2f %.2f", static_cast<double>(camera->eye.x), static_cast<double>(camera->eye.y),
                      static_cast<double>(camera->eye.z));
}

void build_pick(const view_pick *pick) {
  static const char *const statuses[] = {"misses everything", "hits", "unresolved"};
  if (!pick->valid) {
    ImGui::TextDisabled("click on a pixel to ask its ray");
    return;
  }
  ImGui::Text("ray from %.2f %.2f %.2f", static_cast<double>(pick->position[0]), static_cast<double>(pick->position[1]),
              static_cast<double>(pick->position[2]));
  ImGui::Text("%s", statuses[std::min(pick->status, 2u)]);
  if (std::isfinite(pick->distance_metres)) {
    ImGui::SameLine();
    ImGui::Text("after %.2f m", static_cast<double>(pick->distance_metres));
  }
  if (pick->probe != UINT32_MAX) ImGui::Text("probe %u answers", pick->probe);
  ImGui::Text("%u texels read, %u probes asked", pick->steps, pick->probes_tried);
}

void build_overlay(const view_facts *facts, const view_pick *pick, view_state *s) {
  uint32_t overlays = 0;
  for (uint32_t i = 0; i < VIEW_OVERLAYS; i++) overlays |= view_has_overlay(&facts->field, i) ? 1u << i : 0u;
  choose("overlay", VIEW_OVERLAY_WORDS, overlays, &s->overlay);
  explain("What is painted over the picture: probes, which of them answered, rays that none could answer, texels read. "
          "Key O.");
  if (s->overlay >= VIEW_PROBE_INDEX && s->overlay <= VIEW_PROBE_IRRADIANCE) {
    ImGui::SliderFloat("radius", &s->probe_radius, 1e-3f, 10.0f, "%.3f m", ImGuiSliderFlags_Logarithmic);
  }
  if (s->overlay == VIEW_STEPS) ImGui::TextDisabled("dark: few texels read; pale: 512 and more");
  if (s->overlay == VIEW_UNRESOLVED) ImGui::TextDisabled("magenta: no probe knows");
  if (s->overlay == VIEW_MAP) {
    int probe = s->probe == VIEW_ANSWERING ? -1 : static_cast<int>(s->probe);
    const int last = static_cast<int>(facts->field.probes.count) - 1;
    if (ImGui::SliderInt("map of probe", &probe, -1, last, probe < 0 ? "that answers" : "%d")) {
      s->probe = probe < 0 ? VIEW_ANSWERING : static_cast<uint32_t>(probe);
    }
    ImGui::TextDisabled("orange: blocks skipped; green: texels read");
  }
  build_pick(pick);
}

void build_object(view_state *s) {
  ImGui::Checkbox("a ball", &s->object);
  explain("An object that the field does not know: light falls on it, it casts shadows, and the arrows move it. Key X: "
          "matte, chrome, none.");
  if (!s->object) return;
  for (const view_finish &finish : VIEW_FINISHES) {
    ImGui::SameLine();
    if (!ImGui::SmallButton(finish.name)) continue;
    s->object_roughness = finish.roughness;
    s->object_metallic = finish.metallic;
  }
  ImGui::DragFloat3("place", &s->object_position.x, 0.01f);
  ImGui::SliderFloat("size", &s->object_radius, 0.01f, 5.0f, "%.2f m", ImGuiSliderFlags_Logarithmic);
  ImGui::SliderFloat("roughness", &s->object_roughness, 0.0f, 1.0f, "%.2f");
  ImGui::SliderFloat("metallic", &s->object_metallic, 0.0f, 1.0f, "%.2f");
}

float device_milliseconds(const view_timings *t) {
  float sum = 0.0f;
  for (uint32_t i = 0; i < t->pass_count; i++) sum += t->latest[i];
  return sum;
}

void build_times(const view_timings *t) {
  const int shown = static_cast<int>(std::min<uint32_t>(t->frames, VIEW_HISTORY));
  const int first = static_cast<int>(t->frames > VIEW_HISTORY ? t->frames % VIEW_HISTORY : 0);
  float most = 0.0f;
  for (int i = 0; i < shown; i++) most = std::max(most, t->total[i]);
  ImGui::PlotLines("##total", t->total, shown, first, nullptr, 0.0f, most * 1.1f, ImVec2(-1.0f, 40.0f));
  for (uint32_t i = 0; i < t->pass_count; i++) {
    float largest = 0.0f;
    for (int k = 0; k < shown; k++) largest = std::max(largest, t->history[i][k]);
    ImGui::PushID(static_cast<int>(i));
    ImGui::PlotLines("##pass", t->history[i], shown, first, nullptr, 0.0f, largest * 1.1f, ImVec2(110.0f, 15.0f));
    ImGui::SameLine();
    ImGui::Text("%8.3f  %s", static_cast<double>(t->latest[i]), t->names[i]);
    ImGui::PopID();
  }
  if (t->relight.on) build_relight(&t->relight);
}

void build_keys() {
  ImGui::TextDisabled("WASD, Q E      fly; shift faster, control slower\n"
                      "right button   look around; wheel: speed\n"
                      "1 2 ..         mode          T  tracer\n"
                      "O, shift O     overlay       B  selector\n"
                      "R F G          direct, diffuse, glossy\n"
                      "L V            emitters, visibility\n"
                      "- = J          exposure; it follows\n"
                      "[ ]            resolution\n"
                      "C              next camera   N  next map\n"
                      "X, arrows      matte or chrome ball\n"
                      "P              screenshot\n"
                      "M, arrows      the next light; K  it off and on\n"
                      "tab            this panel    escape  quit");
}

// The panel's width: readable, but bounded so that it does not hide the image.
float panel_width() { return std::min(WIDTH * ImGui::GetFontSize(), MOST_OF_WINDOW * ImGui::GetIO().DisplaySize.x); }

void build_window(const view_facts *facts, const view_timings *timings, const view_pick *pick, view_state *s,
                  view_camera *camera) {
  const float height = ImGui::GetIO().DisplaySize.y, width = panel_width();
  ImGui::SetNextWindowPos(ImVec2(12.0f, 12.0f), ImGuiCond_FirstUseEver);
  ImGui::SetNextWindowSizeConstraints(ImVec2(width, 60.0f), ImVec2(width, std::max(height - 24.0f, 61.0f)));
  ImGui::Begin("Octalux", &s->panel, ImGuiWindowFlags_AlwaysAutoResize);
  ImGui::TextDisabled("%s\n%u probes of %u x %u\n%s\n%.3f ms on it", facts->scene_name, facts->field.probes.count,
                      facts->field.maps.size, facts->field.maps.size, facts->device,
                      static_cast<double>(device_milliseconds(timings)));
  ImGui::PushItemWidth(0.55f * width);
  const bool overlaid = s->overlay != VIEW_NO_OVERLAY || s->picked;
  if (ImGui::CollapsingHeader("Light", ImGuiTreeNodeFlags_DefaultOpen)) build_light(s);
  if (ImGui::CollapsingHeader("Camera", ImGuiTreeNodeFlags_DefaultOpen)) build_camera(facts, s, camera);
  if (ImGui::CollapsingHeader("Ball", ImGuiTreeNodeFlags_DefaultOpen)) build_object(s);
  if (ImGui::CollapsingHeader("Lamps, sun and sky", s->light == VIEW_NO_LIGHT ? 0 : ImGuiTreeNodeFlags_DefaultOpen))
    build_lights(&timings->relight, s);
  if (ImGui::CollapsingHeader("Overlays and rays", overlaid ? ImGuiTreeNodeFlags_DefaultOpen : 0))
    build_overlay(facts, pick, s);
  if (ImGui::CollapsingHeader("How light is made")) build_research(facts, s);
  if (ImGui::CollapsingHeader("Time of each pass")) build_times(timings);
  if (ImGui::CollapsingHeader("Keys")) build_keys();
  ImGui::PopItemWidth();
  ImGui::End();
}

// Loads letters at the display's scale: from a font of the system where there is one, otherwise the built-in one,
// enlarged.
void load_letters(GLFWwindow *window) {
  static const char *const files[] = {"/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf",
                                      "/usr/share/fonts/truetype/liberation2/LiberationSans-Regular.ttf",
                                      "/usr/share/fonts/truetype/noto/NotoSans-Regular.ttf"};
  float scale = 1.0f, other = 1.0f;
  if (window) glfwGetWindowContentScale(window, &scale, &other);
  scale = std::clamp(scale, 1.0f, 4.0f);
  ImGui::GetStyle().ScaleAllSizes(scale);
  ImGuiIO &io = ImGui::GetIO();
  for (const char *file : files) {
    if (access(file, R_OK) == 0 && io.Fonts->AddFontFromFileTTF(file, LETTER * scale)) return;
  }
  ImFontConfig built_in;
  built_in.SizePixels = std::floor(13.0f * scale);
  io.Fonts->AddFontDefault(&built_in);
}

bool create_pool(VkDevice device, VkDescriptorPool *pool) {
  const VkDescriptorPoolSize size = {VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, 4};
  VkDescriptorPoolCreateInfo info = {};
  info.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO;
  info.flags = VK_DESCRIPTOR_POOL_CREATE_FREE_DESCRIPTOR_SET_BIT;
  info.maxSets = 4;
  info.poolSizeCount = 1;
  info.pPoolSizes = &size;
  return vkCreateDescriptorPool(device, &info, nullptr, pool) == VK_SUCCESS;
}

} // namespace

view_panel *view_panel_create(const olx_vulkan_host *host, VkRenderPass render_pass, GLFWwindow *window) {
  view_panel *panel = new (std::nothrow) view_panel();
  if (!panel) return nullptr;
  panel->device = host->device;
  panel->context = ImGui::CreateContext();
  ImGuiIO &io = ImGui::GetIO();
  io.IniFilename = nullptr;
  set_style();
  load_letters(window);
  if (window) panel->has_window = ImGui_ImplGlfw_InitForVulkan(window, true);
  ImGui_ImplVulkan_InitInfo info = {};
  if (create_pool(host->device, &panel->pool)) {
    info.Instance = host->instance;
    info.PhysicalDevice = host->physical_device;
    info.Device = host->device;
    info.QueueFamily = host->queue_family;
    info.Queue = host->queue;
    info.DescriptorPool = panel->pool;
    info.MinImageCount = info.ImageCount = 2;
    info.MSAASamples = VK_SAMPLE_COUNT_1_BIT;
    info.CheckVkResultFn = refuse;
    try {
      panel->has_backend = true; // set as soon as the backend is initialized
      ImGui_ImplVulkan_Init(&info, render_pass);
      return panel;
    } catch (VkResult) {}
  }
  view_panel_destroy(panel);
  return nullptr;
}

void view_panel_destroy(view_panel *panel) {
  if (!panel) return;
  if (panel->has_backend) ImGui_ImplVulkan_Shutdown();
  if (panel->has_window) ImGui_ImplGlfw_Shutdown();
  ImGui::DestroyContext(panel->context);
  if (panel->pool) vkDestroyDescriptorPool(panel->device, panel->pool, nullptr);
  delete panel;
}

bool view_panel_upload(view_panel *, VkCommandBuffer commands) {
  try {
    return ImGui_ImplVulkan_CreateFontsTexture(commands);
  } catch (VkResult) {
    return false;
  }
}

void view_panel_uploaded(view_panel *) { ImGui_ImplVulkan_DestroyFontUploadObjects(); }

void view_panel_takes(const view_panel *, bool *mouse, bool *keys) {
  *mouse = ImGui::GetIO().WantCaptureMouse;
  *keys = ImGui::GetIO().WantTextInput;
}

void view_panel_build(view_panel *panel, const uint32_t size[2], float seconds, const view_facts *facts,
                      const view_timings *timings, const view_pick *pick, view_state *s, view_camera *camera) {
  ImGuiIO &io = ImGui::GetIO();
  // A window that fits its content exists only from the second layout on.
  for (const int needed = ImGui::GetFrameCount() + (ImGui::GetFrameCount() == 0 ? 2 : 1);
       ImGui::GetFrameCount() < needed;) {
    if (panel->has_window) ImGui_ImplGlfw_NewFrame();
    io.DisplaySize = ImVec2(static_cast<float>(size[0]), static_cast<float>(size[1]));
    io.DeltaTime = std::max(seconds, 1e-4f);
    ImGui_ImplVulkan_NewFrame();
    ImGui::NewFrame();
    if (s->panel) build_window(facts, timings, pick, s, camera);
    ImGui::Render();
  }
}

bool view_panel_record(view_panel *, VkCommandBuffer commands) {
  try {
    ImGui_ImplVulkan_RenderDrawData(ImGui::GetDrawData(), commands);
    return true;
  } catch (VkResult) {
    return false;
  }
}
