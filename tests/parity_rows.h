// The rows of the parity test: one for each function of shaders/lib, in the order in which they run. C and GLSL read this.
#ifndef PARITY_ROWS_H
#define PARITY_ROWS_H

#define PARITY_ITEMS 8192  // of every row: a multiple of the workgroup
#define PARITY_GROUPS 5
#define PARITY_RESULTS 18  // words an item may give

#define ROW_olx_square 0
#define ROW_olx_sign_not_zero 1
#define ROW_olx_dot 2
#define ROW_olx_normalize 3
#define ROW_olx_basis 4
#define ROW_olx_from_basis 5
#define ROW_olx_octahedral_encode 6
#define ROW_olx_octahedral_point 7
#define ROW_olx_octahedral_decode 8
#define ROW_olx_texel_solid_angle_near 9
#define ROW_olx_half_unpack 10
#define ROW_olx_normal_unpack 11
#define ROW_olx_hash 12
#define ROW_olx_hash2 13
#define ROW_olx_unit_float 14
#define ROW_olx_owen_scramble 15
#define ROW_olx_sobol2 16
#define ROW_olx_stratified2 17
#define ROW_olx_sample_cosine 18
#define ROW_olx_bsdf_make 19
#define ROW_olx_pow5 20
#define ROW_olx_fresnel 21
#define ROW_olx_bsdf_diffuse 22
#define ROW_olx_bsdf_has_specular 23
#define ROW_olx_ggx_lambda 24
#define ROW_olx_ggx_sample_half 25
#define ROW_olx_ggx_sample 26
#define ROWS_OF_CORE 27

#define ROW_olx_probe_position 27
#define ROW_olx_irradiance_probe_position 28
#define ROW_olx_map_corner 29
#define ROW_olx_map_origin 30
#define ROW_olx_texel_towards 31
#define ROW_olx_texel_distance_bits 32
#define ROW_olx_texel_distance 33
#define ROW_olx_texel_emits 34
#define ROW_olx_texel_normal 35
#define ROW_olx_texel_radiance 36
#define ROW_olx_irradiance_coordinate 37
#define ROW_olx_cage_at 38
#define ROW_olx_cage_has 39
#define ROW_olx_cage_probe 40
#define ROW_olx_cage_weight 41
#define ROW_olx_select_available 42
#define ROW_olx_select_resolve 43
#define ROW_olx_sample_settings_default 44
#define ROWS_OF_FIELD 45

#define ROW_olx_radius_squared 45
#define ROW_olx_farthest_squared 46
#define ROW_olx_reach_squared 47
#define ROW_olx_nearest_squared 48
#define ROW_olx_clamp_texel 49
#define ROW_olx_image_at 50
#define ROW_olx_parameter_at 51
#define ROW_olx_crossing 52
#define ROW_olx_texel_at 53
#define ROW_olx_pyramid_shift 54
#define ROW_olx_pyramid_index 55
#define ROW_olx_least_squared 56
#define ROW_olx_read_surfel 57
#define ROW_olx_plane_tolerance 58
#define ROW_olx_beyond_reach 59
#define ROW_olx_supported 60
#define ROW_olx_judge_height 61
#define ROW_olx_judge_surfel 62
#define ROW_olx_visit_texel 63
#define ROW_olx_next_cell 64
#define ROW_olx_crossings_ahead 65
#define ROW_olx_march_texels 66
#define ROW_olx_march_two_level 67
#define ROW_olx_leave 68
#define ROW_olx_march_node 69
#define ROW_olx_visit_first 70
#define ROW_olx_march_hiz 71
#define ROW_olx_march_piece 72
#define ROW_olx_end_at 73
#define ROW_olx_make_axis 74
#define ROW_olx_plane_at 75
#define ROW_olx_sign_after 76
#define ROW_olx_make_piece 77
#define ROW_olx_next_cut 78
#define ROW_olx_begin_march 79
#define ROW_olx_trace_probe 80
#define ROWS_OF_MARCH 81

#define ROW_olx_usable 81
#define ROW_olx_is_ray 82
#define ROW_olx_was_asked 83
#define ROW_olx_ray_point 84
#define ROW_olx_line_distance_squared 85
#define ROW_olx_sees 86
#define ROW_olx_ask 87
#define ROW_olx_first_corner 88
#define ROW_olx_search_cages 89
#define ROW_olx_search_everywhere 90
#define ROW_olx_search_selected 91
#define ROW_olx_sky_radiance 92
#define ROW_olx_describe 93
#define ROW_olx_leave_bounds 94
#define ROW_olx_trace 95
#define ROW_olx_probe_sees 96
#define ROW_olx_bricks_list 97
#define ROW_olx_bricks_probe 98
#define ROW_olx_next_listed 99
#define ROW_olx_search_bricks 100
#define ROWS_OF_SEARCH 101

#define ROW_olx_map_irradiance 101
#define ROW_olx_map_moments 102
#define ROW_olx_chebyshev 103
#define ROW_olx_visibility 104
#define ROW_olx_probe_weight 105
#define ROW_olx_irradiance_usable 106
#define ROW_olx_nearest_visible 107
#define ROW_olx_add_from_afar 108
#define ROW_olx_irradiance 109
#define ROW_olx_glossy 110
#define ROWS_OF_SHADE 111

#endif
