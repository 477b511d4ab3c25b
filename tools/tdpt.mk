# tdpt.mk: how Make gets from scenes to portals and pictures; tdpt.mk(7) tells how to use it. GNU Make 4.2 or newer.
#
#   room.glb|gltf -> room.max -> room.cut -> room.vdb -> room.portal.glb -> room.exr
#
# What is known of a target lies in .tdpt: TARGET.d, what it was made from, and TARGET.command, the part of its command
# that shapes it. A result is made as room.partial.exr and gets its name when it is whole, so nothing that is half made
# has to be deleted, and what a stopped render has written stays.

# A shell may have variables of these common names that mean something else.
$(foreach name,ENVIRONMENT ENVIRONMENT_FLAGS PORTALS PREVIEWS QUALITY QUIET SEED THREADS,\
  $(if $(filter environment,$(origin $(name))),$(eval undefine $(name))))

FFGRAPH ?= $(TDPT_BIN)ffgraph
MINCUT ?= $(TDPT_BIN)mincut
LIGHTGRID ?= $(TDPT_BIN)lightgrid
PORTALFIT ?= $(TDPT_BIN)portalfit
TDPT_RENDER ?= $(TDPT_BIN)tdpt-render

# The pictures of all scenes in this folder.
TDPT_PICTURES = $(sort $(addsuffix .exr,$(basename $(filter-out %.portal.glb %.portal.gltf %.partial.glb,$(wildcard *.glb *.gltf)))))

# What of the commands shapes the results, and what does not.
tdpt_all = $(if $(SEED),--seed $(SEED)) $(if $(QUALITY),--quality $(QUALITY))
tdpt_sky = $(if $(ENVIRONMENT),--environment $(ENVIRONMENT)) $(ENVIRONMENT_FLAGS)
tdpt_max = $(strip $(FFGRAPH) $(tdpt_sky) $(tdpt_all) $(FFGRAPH_FLAGS))
tdpt_cut = $(strip $(MINCUT) $(tdpt_all) $(MINCUT_FLAGS))
tdpt_vdb = $(strip $(LIGHTGRID) $(tdpt_sky) $(tdpt_all) $(LIGHTGRID_FLAGS))
tdpt_glb = $(strip $(PORTALFIT) $(tdpt_all) $(PORTALFIT_FLAGS))
tdpt_exr = $(strip $(TDPT_RENDER) $(addprefix --portal ,$(tdpt_portals)) $(tdpt_sky) $(tdpt_all) $(TDPT_RENDER_FLAGS))
tdpt_free = $(if $(THREADS),--threads $(THREADS)) \
  $(if $(or $(QUIET),$(if $(TDPT_STATUS),,$(findstring s,$(firstword -$(MAKEFLAGS))))),--quiet)

# Of the target in whose rule they stand, $* being its stem: scene, portals, file of the sky. A portal is no scene.
# Which scene another picture shows is looked up by its name: a variable of the target would hold for all that it needs.
tdpt_stem = $(or $(SCENE.$*),$*)
tdpt_scene = $(or $(if $(filter %.portal,$(tdpt_stem)),.tdpt/a-portal-is-no-scene),\
  $(firstword $(wildcard $(tdpt_stem).glb $(tdpt_stem).gltf)),$(tdpt_stem).glb)
tdpt_portals = $(if $(filter undefined,$(origin PORTALS)),$(tdpt_stem).portal.glb,$(PORTALS))
tdpt_sky_file = $(if $(or $(findstring /,$(ENVIRONMENT)),$(filter %.exr %.hdr %.pic,$(ENVIRONMENT))),$(ENVIRONMENT))
# A portal that is there and not of portalfit was drawn by hand and stays.
tdpt_by_hand = $(if $(wildcard $@),$(if $(shell grep -c '"generator":"tdpt ' '$@' | grep -v '^0'),,$@))

# tdpt-again where the target was made by another command than $1, or preview $2 is asked for and missing.
tdpt_known = .tdpt/$(subst ../,up/,$@)
tdpt_differ = $(if $1,$(subst x$1,,x$2)$(subst x$2,,x$1))
tdpt_again = $(if $(or $(call tdpt_differ,$(strip $(file <$(tdpt_known).command)),$1),\
  $(if $(PREVIEWS),$(if $(wildcard $2),,missing))),tdpt-again)

tdpt_partial = $(basename $@).partial$(suffix $@)
tdpt_preview = $(if $(PREVIEWS),--preview $@.png)
tdpt_to = -o $(tdpt_partial) -MF $(tdpt_known).d -MQ $@
tdpt_quoted = '$(subst ','\'',$1)'
# A caller who wants the exit code of what failed names a file for it.
tdpt_told = $(if $(TDPT_STATUS), || { code=$$?; echo $$code >$(TDPT_STATUS); exit $$code; })
tdpt_begin = @mkdir -p $(dir $(tdpt_known))
define tdpt_end
@mv -f $(tdpt_partial) $@
@printf '%s\n' $(call tdpt_quoted,$1) >$(tdpt_known).command
endef

.PHONY: tdpt-again
.PRECIOUS: %.max %.cut %.vdb %.portal.glb
.SECONDEXPANSION:

%.max: $$(tdpt_scene) $$(tdpt_sky_file) $$(call tdpt_again,$$(tdpt_max),$$@.png)
	$(tdpt_begin)
	$(tdpt_max) $(tdpt_free) $(tdpt_preview) $< $(tdpt_to)$(tdpt_told)
	$(call tdpt_end,$(tdpt_max))

%.cut: %.max $$(if $$(PREVIEWS),$$(tdpt_scene)) $$(call tdpt_again,$$(tdpt_cut),$$@.png)
	$(tdpt_begin)
	$(tdpt_cut) $(tdpt_free) $(tdpt_preview) $(if $(PREVIEWS),--scene $(tdpt_scene)) $< $(tdpt_to)$(tdpt_told)
	$(call tdpt_end,$(tdpt_cut))

%.vdb: $$(tdpt_scene) %.cut $$(tdpt_sky_file) $$(call tdpt_again,$$(tdpt_vdb),$$@.png)
	$(tdpt_begin)
	$(tdpt_vdb) $(tdpt_free) $(tdpt_preview) $< $*.cut $(tdpt_to)$(tdpt_told)
	$(call tdpt_end,$(tdpt_vdb))

%.portal.glb: $$(if $$(tdpt_by_hand),,$$*.vdb $$(call tdpt_again,$$(tdpt_glb),$$@.png))
	$(tdpt_begin)
	$(tdpt_glb) $(tdpt_free) $(tdpt_preview) $< $(tdpt_to)$(tdpt_told)
	$(call tdpt_end,$(tdpt_glb))

# The preview of a picture lies beside it under its name with .png: that of a texture, perhaps.
%.exr: $$(tdpt_scene) $$(tdpt_portals) $$(tdpt_sky_file) $$(call tdpt_again,$$(tdpt_exr),$$@.png)
	$(if $(filter $(abspath $@),$(abspath $(ENVIRONMENT))),$(error $@ would replace its own sky))
	$(tdpt_begin)
	$(tdpt_exr) $(tdpt_free) $(if $(PREVIEWS),--preview) $< $(tdpt_to)$(tdpt_told)
	$(if $(PREVIEWS),@mv -f $(basename $(tdpt_partial)).png $@.png)
	$(call tdpt_end,$(tdpt_exr))

# What was read, and empty rules for that; none of them is what a plain `make` makes.
.tdpt/%.d: ;
tdpt_goal := $(.DEFAULT_GOAL)
-include $(shell find .tdpt -name '*.d' -type f 2>/dev/null)
.DEFAULT_GOAL := $(tdpt_goal)
