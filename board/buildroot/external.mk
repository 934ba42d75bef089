include $(sort $(wildcard $(BR2_EXTERNAL_ROOMCAL_PATH)/package/*/*.mk))
