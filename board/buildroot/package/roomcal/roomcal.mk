################################################################################
#
# roomcal
#
################################################################################

ROOMCAL_VERSION = 0.1.0
# The tree that this file lies in; pin a release with ROOMCAL_OVERRIDE_SRCDIR or a site of your own.
ROOMCAL_SITE = $(BR2_EXTERNAL_ROOMCAL_PATH)/../..
ROOMCAL_SITE_METHOD = local
ROOMCAL_LICENSE = Apache-2.0
ROOMCAL_LICENSE_FILES = LICENSE
ROOMCAL_DEPENDENCIES = eigen flatbuffers host-flatbuffers host-python3

ROOMCAL_CONF_OPTS = \
	-DROOMCAL_HARDEN=ON \
	-DROOMCAL_TOOLS=OFF \
	-DROOMCAL_TESTS=OFF \
	-DROOMCAL_BENCHMARKS=OFF \
	-DROOMCAL_ARAVIS=OFF

ifeq ($(BR2_PACKAGE_ROOMCAL_MJPEG),y)
ROOMCAL_CONF_OPTS += -DROOMCAL_MJPEG=ON
ROOMCAL_DEPENDENCIES += jpeg
else
ROOMCAL_CONF_OPTS += -DROOMCAL_MJPEG=OFF
endif

ifeq ($(BR2_PACKAGE_ROOMCAL_LIBCAMERA),y)
ROOMCAL_CONF_OPTS += -DROOMCAL_LIBCAMERA=ON
ROOMCAL_DEPENDENCIES += libcamera
else
ROOMCAL_CONF_OPTS += -DROOMCAL_LIBCAMERA=OFF
endif

define ROOMCAL_NAME_THE_PRODUCT
	$(SED) 's/^ROOMCAL_BOARD=.*/ROOMCAL_BOARD=$(call qstrip,$(BR2_PACKAGE_ROOMCAL_BOARD))/' \
		$(TARGET_DIR)/etc/default/roomcald
endef
ROOMCAL_POST_INSTALL_TARGET_HOOKS += ROOMCAL_NAME_THE_PRODUCT

define ROOMCAL_INSTALL_INIT_SYSV
	$(INSTALL) -D -m 755 $(@D)/board/service/roomcald.init $(TARGET_DIR)/etc/init.d/S60roomcald
endef

define ROOMCAL_USERS
	roomcal -1 roomcal -1 * /var/lib/roomcal - video,input,dialout roomcal calibration
endef

define ROOMCAL_LINUX_CONFIG_FIXUPS
	$(call KCONFIG_ENABLE_OPT,CONFIG_INPUT_EVDEV)
	$(call KCONFIG_ENABLE_OPT,CONFIG_KEYBOARD_GPIO)
	$(call KCONFIG_ENABLE_OPT,CONFIG_LEDS_GPIO)
	$(call KCONFIG_ENABLE_OPT,CONFIG_GPIO_CDEV)
	$(call KCONFIG_ENABLE_OPT,CONFIG_CAN)
	$(call KCONFIG_ENABLE_OPT,CONFIG_CAN_RAW)
	$(call KCONFIG_ENABLE_OPT,CONFIG_MEDIA_SUPPORT)
	$(call KCONFIG_ENABLE_OPT,CONFIG_WATCHDOG)
endef

$(eval $(cmake-package))
