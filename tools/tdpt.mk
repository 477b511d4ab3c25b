# tdpt.mk: how Make gets from scenes to portals and pictures; tdpt.mk(7) tells how to use it. GNU Make 4.2 or newer.
#
#   room.glb|gltf -> room.max -> room.cut -> room.vdb -> room.portal.glb -> room.exr
#
# What is known of a target lies in .tdpt: TARGET.d, what it was made from, and TARGET.command, the part of its command
# that shapes it. A result is made as room.partial.exr and gets its name when it is whole, so nothing that is half made
# has to be deleted, and what a stopped render has written stays.

# A shell may have variables of these common names that mean something else.
$(foreach name,AT CAMERA_FLAGS DEVICE ENVIRONMENT ENVIRONMENT_FLAGS MAX_MEMORY PORTALS PREVIEWS QUALITY QUIET SEED THREADS TDPT_TELL,\
  $(if $(filter environment,$(origin $(name))),$(eval undefine $(name))))

FFGRAPH ?= $(TDPT_BIN)ffgraph
MINCUT ?= $(TDPT_BIN)mincut
LIGHTGRID ?= $(TDPT_BIN)lightgrid
PORTALFIT ?= $(TDPT_BIN)portalfit
TDPT_RENDER ?= $(TDPT_BIN)tdpt-render
EXRDIFF ?= $(TDPT_BIN)exrdiff
TDPT_INFO ?= $(TDPT_BIN)tdpt-info
PYTHON ?= python3
# Of a report: CPU seconds of each picture, samples of the reference over theirs, pixels across.
REPORT_TIME ?= 10
REPORT_REFERENCE ?= 8
REPORT_WIDTH ?= 320
tdpt_rules := $(dir $(lastword $(MAKEFILE_LIST)))
tdpt_measure := $(firstword $(wildcard $(tdpt_rules)tdpt/report_measure.py $(tdpt_rules)report_measure.py))

# The pictures of all scenes in this folder.
TDPT_PICTURES = $(sort $(addsuffix .exr,$(basename $(filter-out %.portal.glb %.portal.gltf %.partial.glb,$(wildcard *.glb *.gltf)))))

# What of the commands shapes the results, and what does not.
tdpt_sampling = $(if $(SEED),--seed $(SEED)) $(if $(QUALITY),--quality $(QUALITY))
tdpt_sky = $(if $(ENVIRONMENT),--environment $(ENVIRONMENT)) $(ENVIRONMENT_FLAGS)
# Of a scene: the cameras for which its network is made together; their portals lie in one file.
tdpt_cameras = $(foreach name,$(CAMERAS.$*),--camera $(call tdpt_quoted,$(name)))
tdpt_camera = $(if $(CAMERA.$*),$(if $(filter --%,$(CAMERA.$*)),$(CAMERA.$*),--camera $(call tdpt_quoted,$(CAMERA.$*)))) $(CAMERA_FLAGS)
tdpt_pose = $(if $(AT),--at $(AT))
tdpt_device = $(if $(DEVICE),--device $(call tdpt_quoted,$(DEVICE)))
tdpt_max = $(strip $(FFGRAPH) $(or $(tdpt_cameras),$(tdpt_camera)) $(tdpt_pose) $(tdpt_sky) $(tdpt_sampling) $(FFGRAPH_FLAGS))
tdpt_cut = $(strip $(MINCUT) $(MINCUT_FLAGS))
tdpt_vdb = $(strip $(LIGHTGRID) $(tdpt_pose) $(tdpt_sky) $(tdpt_device) $(tdpt_sampling) $(LIGHTGRID_FLAGS))
tdpt_glb = $(strip $(PORTALFIT) $(PORTALFIT_FLAGS))
tdpt_exr = $(strip $(TDPT_RENDER) $(addprefix --portal ,$(tdpt_portals)) $(tdpt_camera) $(tdpt_pose) $(tdpt_sky) $(tdpt_device) $(tdpt_sampling) $(TDPT_RENDER_FLAGS))
tdpt_html = $(strip report $(REPORT_TIME) $(REPORT_REFERENCE) $(REPORT_WIDTH) $(tdpt_exr))
tdpt_quiet = $(if $(or $(QUIET),$(findstring s,$(firstword -$(MAKEFLAGS)))),--quiet)
tdpt_most = $(if $(MAX_MEMORY),--max-memory $(MAX_MEMORY))
tdpt_free = $(if $(THREADS),--threads $(THREADS)) $(tdpt_most) $(if $(TDPT_TELL),,$(tdpt_quiet))

# Of the target in whose rule they stand, $* being its stem: scene, portals, file of the sky. A portal is no scene.
# Which scene another picture shows, and through which camera, is looked up by its name: a variable of the target would
# hold for all that it needs. Portals belong to a camera: a picture that names one has its own, unless its scene's
# portals are for several.
tdpt_stem = $(or $(SCENE.$*),$*)
tdpt_scene = $(or $(if $(filter %.portal,$(tdpt_stem)),.tdpt/a-portal-is-no-scene),\
  $(firstword $(wildcard $(tdpt_stem).glb $(tdpt_stem).gltf)),$(tdpt_stem).glb)
tdpt_portals = $(if $(filter undefined,$(origin PORTALS)),$(if $(CAMERA.$*),$(if $(CAMERAS.$(tdpt_stem)),$(tdpt_stem),$*),$(tdpt_stem)).portal.glb,$(PORTALS))
tdpt_sky_file = $(if $(or $(findstring /,$(ENVIRONMENT)),$(filter %.exr %.hdr %.pic,$(ENVIRONMENT))),$(ENVIRONMENT))
# A portal that is there and not of portalfit was drawn by hand and stays.
tdpt_drawn = $(if $(wildcard $1),$(if $(shell grep -c '"generator":"tdpt ' '$1' | grep -v '^0'),,$1))
tdpt_by_hand = $(call tdpt_drawn,$@)
# Of a report: whose stages found its portals; nothing where none did.
tdpt_found = $(patsubst %.portal.glb,%,$(firstword $(foreach file,$(filter %.portal.glb,$(tdpt_portals)),\
  $(if $(call tdpt_drawn,$(file)),,$(file)))))

# tdpt-again where the target was made by another command than $1, or preview $2 is asked for and missing.
tdpt_known = .tdpt/$(subst ../,up/,$@)
tdpt_differ = $(if $1,$(subst x$1,,x$2)$(subst x$2,,x$1))
# Also where a report is asked for and stage $3 has not told of itself.
tdpt_again = $(if $(or $(call tdpt_differ,$(strip $(file <$(tdpt_known).command)),$1),\
  $(if $(PREVIEWS),$(if $(wildcard $2),,missing)),$(if $(and $(TDPT_TELL),$3),$(if $(wildcard $(tdpt_known).told.json),,untold))),tdpt-again)

tdpt_partial = $(basename $@).partial$(suffix $@)
# The plan of the portals has words to read: a report takes it as SVG, unless it is asked for as PNG, too.
tdpt_told_as = $(if $(PREVIEWS),png,$(if $(filter %.portal.glb,$@),svg,png))
tdpt_preview = $(if $(or $(PREVIEWS),$(TDPT_TELL)),--preview $(if $(TDPT_TELL),$(tdpt_telling).$(tdpt_told_as),$@.png))
tdpt_shown = $(if $(or $(PREVIEWS),$(TDPT_TELL)),--scene $(tdpt_scene) $(tdpt_pose))
# A stage that runs for a report keeps what it tells of itself and its picture beside .command; its notes come afterwards.
tdpt_telling = $(tdpt_known).partial.told
tdpt_notes = grep -v ', because '
tdpt_tell = $(if $(TDPT_TELL), --json --explain >$(tdpt_telling).json 2>$(tdpt_telling).txt || \
  { code=$$?; $(tdpt_notes) $(tdpt_telling).txt >&2; (exit $$code); })
define tdpt_keep
$(if $(TDPT_TELL),@$(tdpt_notes) $(tdpt_telling).txt $(if $(tdpt_quiet),| grep warning) >&2 || :
@$(if $(PREVIEWS),cp $(tdpt_telling).png $@.png;) rm -f $(tdpt_known).told.png $(tdpt_known).told.svg; for end in $(tdpt_told_as) txt json; do \
  mv -f $(tdpt_telling).$$end $(tdpt_known).told.$$end; done; touch $(tdpt_known).told.json)
endef
tdpt_to = -o $(tdpt_partial) -MF $(tdpt_known).d -MQ $@
tdpt_quoted = '$(subst ','\'',$1)'
tdpt_begin = @mkdir -p $(dir $(tdpt_known))
# A stage that runs for a report alone makes the same bytes: they keep their time, and no picture is made anew for it.
define tdpt_end
$(if $(TDPT_TELL),@if cmp -s $(tdpt_partial) $@; then touch -r $@ $(tdpt_partial); fi)
@mv -f $(tdpt_partial) $@
@printf '%s\n' $(call tdpt_quoted,$1) >$(tdpt_known).command
endef

# Every line says which file it is about: with -j they come in turns.
export TDPT_ABOUT = $(if $(TDPT_TELL),,$@)

.PHONY: tdpt-again
.PRECIOUS: %.max %.cut %.vdb %.portal.glb
.SECONDEXPANSION:

%.max: $$(tdpt_scene) $$(tdpt_sky_file) $$(call tdpt_again,$$(tdpt_max),$$@.png,stage)
	$(tdpt_begin)
	$(tdpt_max) $(tdpt_free) $(tdpt_preview) $< $(tdpt_to)$(tdpt_tell)
	$(call tdpt_end,$(tdpt_max))
	$(tdpt_keep)

%.cut: %.max $$(if $$(or $$(PREVIEWS),$$(TDPT_TELL)),$$(tdpt_scene)) $$(call tdpt_again,$$(tdpt_cut),$$@.png,stage)
	$(tdpt_begin)
	$(tdpt_cut) $(tdpt_free) $(tdpt_preview) $(tdpt_shown) $< $(tdpt_to)$(tdpt_tell)
	$(call tdpt_end,$(tdpt_cut))
	$(tdpt_keep)

%.vdb: $$(tdpt_scene) %.cut $$(tdpt_sky_file) $$(call tdpt_again,$$(tdpt_vdb),$$@.png,stage)
	$(tdpt_begin)
	$(tdpt_vdb) $(tdpt_free) $(tdpt_preview) $< $*.cut $(tdpt_to)$(tdpt_tell)
	$(call tdpt_end,$(tdpt_vdb))
	$(tdpt_keep)

%.portal.glb: $$(if $$(tdpt_by_hand),,$$*.vdb $$(if $$(or $$(PREVIEWS),$$(TDPT_TELL)),$$(tdpt_scene)) \
  $$(call tdpt_again,$$(tdpt_glb),$$@.png,stage))
	$(tdpt_begin)
	$(tdpt_glb) $(tdpt_free) $(tdpt_preview) $(tdpt_shown) $< $(tdpt_to)$(tdpt_tell)
	$(call tdpt_end,$(tdpt_glb))
	$(tdpt_keep)

# The preview of a picture lies beside it under its name with .png: that of a texture, perhaps.
%.exr: $$(tdpt_scene) $$(tdpt_portals) $$(tdpt_sky_file) $$(call tdpt_again,$$(tdpt_exr),$$@.png)
	$(if $(filter $(abspath $@),$(abspath $(ENVIRONMENT))),$(error $@ would replace its own sky))
	$(tdpt_begin)
	$(tdpt_exr) $(tdpt_free) $(if $(PREVIEWS),--preview) $< $(tdpt_to)
	$(if $(PREVIEWS),@mv -f $(basename $(tdpt_partial)).png $@.png,$(if $(filter --preview,$(TDPT_RENDER_FLAGS)),@mv -f $(basename $(tdpt_partial)).png $(basename $@).png))
	$(call tdpt_end,$(tdpt_exr))

# One page of what the stages and two renderings tell. The stages tell of themselves: one that ran before, without, runs
# again for it.
%.report.html: TDPT_TELL = 1
%.report.html: $$(tdpt_scene) $$(tdpt_portals) $$(if $$(tdpt_found),$$(addprefix $$(tdpt_found),.max .cut .vdb)) \
  $$(tdpt_sky_file) $$(call tdpt_again,$$(tdpt_html),$$@)
	$(tdpt_begin)
	$(PYTHON) -B $(tdpt_measure) --scene $< --folder $(tdpt_known).parts --page $(tdpt_partial) --time $(REPORT_TIME) \
	  --reference $(REPORT_REFERENCE) --width $(REPORT_WIDTH) --exrdiff $(EXRDIFF) --info $(TDPT_INFO) $(if $(tdpt_found),\
	  --stem $(tdpt_found) --known .tdpt/$(subst ../,up/,$(tdpt_found))) $(if $(THREADS),--threads $(THREADS)) $(tdpt_quiet) \
	  -MF $(tdpt_known).d -MQ $@ -- $(tdpt_exr) $(tdpt_most)
	$(call tdpt_end,$(tdpt_html))

# What was read, and empty rules for that; none of them is what a plain `make` makes.
.tdpt/%.d: ;
tdpt_goal := $(.DEFAULT_GOAL)
-include $(shell find .tdpt -name '*.d' -type f 2>/dev/null)
.DEFAULT_GOAL := $(tdpt_goal)
