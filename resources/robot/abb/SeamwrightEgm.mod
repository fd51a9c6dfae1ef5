MODULE SeamwrightEgm
    ! Path correction by Seamwright (driver abb-egm) in every sample of Externally Guided Motion, option 689-1.
    ! System parameters: Communication, Transmission Protocol: Name UCdevice, Type UDPUC, Remote Address the
    ! computer of Seamwright, Remote Port Number 6510. Motion, External Motion Interface Data: a configuration
    ! named SeamwrightPath with Level Path.
    ! The controller asks every SampleRate ms (a multiple of 4); give Seamwright the same as "cycle_ms".
    LOCAL VAR egmident egm_id;

    ! Seamwright answers as long as the path has its permission. When that goes on the path, or the connection, no answer
    ! comes within CommTimeout: the path is stopped where it is and raises, it is not run uncorrected.
    ! Set up before the path, robot standing in a fine point. The sensor frame is that of the tool.
    PROC SeamwrightEgmOn(PERS tooldata tool_used)
        EGMReset egm_id;
        EGMGetId egm_id;
        EGMSetupUC ROB_1, egm_id, "SeamwrightPath", "UCdevice"\PathCorr\APTR\CommTimeout:=1;
        EGMActMove egm_id, tool_used.tframe\SampleRate:=48;
    ENDPROC

    PROC SeamwrightEgmOff()
        EGMReset egm_id;
    ENDPROC

    ! A path in the shape that EGM wants, called behind SW_Measure: up to the start by ordinary motion with a fine
    ! point, then by EGMMoveL and EGMMoveC only, away by ordinary motion. Joint motion is not corrected.
    ! EGM corrects only a robot that moves along its path, and Seamwright gives its permission once the robot shows the
    ! whole correction. So from start to seam lies a lead-in with the process off, as long as the correction takes: at
    ! 100 mm/s some 150 mm for 10 mm. While it runs the permission is waited for; without it the seam is not run.
    PROC SeamwrightEgmPath(robtarget start, robtarget seam, robtarget on_arc, robtarget end, PERS tooldata tool_used,
        PERS wobjdata wobj_used, speeddata speed)
        MoveL start, speed, fine, tool_used\WObj:=wobj_used;
        SeamwrightEgmOn tool_used;
        EGMMoveL egm_id, seam, speed, z5, tool_used\WObj:=wobj_used;
        IF NOT SW_Take() THEN
            SeamwrightEgmOff;
            TPWrite "Seamwright has not released this part";
            Stop;
            EXIT;
        ENDIF
        ! Here the process begins.
        EGMMoveC egm_id, on_arc, end, speed, fine, tool_used\WObj:=wobj_used;
        ! Here it ends. Seamwright hears that EGM stands at the end of its path before EGM is gone.
        WaitTime 0.5;
        SeamwrightEgmOff;
    ERROR
        IF ERRNO = ERR_UDPUC_COMM THEN
            ! What is left of the path is forgotten: a StartMove of who handles this does not run it uncorrected.
            StopMove\Quick;
            ClearPath;
            SeamwrightEgmOff;
            StartMove;
            TPWrite "Seamwright took its permission back or is gone: the path was stopped (EGM)";
        ENDIF
        RAISE;
    ENDPROC
ENDMODULE
