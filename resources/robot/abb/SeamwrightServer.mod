MODULE SeamwrightServer
    ! Talks to Seamwright (driver abb-rapid). Load it into a task of its own: Controller configuration, Task
    ! SEAMWRIGHT, Type SemiStatic, Main entry SW_Server, TrustLevel NoSafety. It shares the data below with
    ! Seamwright.mod in T_ROB1. System outputs to configure: sw_doMotorsOn (Motors On State), sw_doEStop
    ! (Emergency Stop), sw_doCycleOn (Cycle On).
    ! Options: 616-1 PC Interface, 623-1 Multitasking.
    PERS bool swCall;
    PERS string swPart;
    PERS bool swGo;
    PERS bool swBusy;
    PERS bool swEnded;
    PERS bool swReleased;
    PERS num swFired;
    PERS string swSpotName{64};
    PERS pose swAt{64};
    PERS bool swTeaching;
    PERS bool swMove;
    PERS pose swMoveTo;
    PERS string swSignature;
    PERS num swCount;

    LOCAL VAR socketdev server;
    LOCAL VAR socketdev client;
    LOCAL VAR string line1;
    LOCAL VAR string line2;
    LOCAL VAR string line3;
    LOCAL VAR string staged_name{32};
    LOCAL VAR pose staged{32};
    LOCAL VAR num staged_count:=0;
    LOCAL VAR num told:=0;
    LOCAL VAR num starts:=0;
    LOCAL VAR bool measuring:=FALSE;

    PROC SW_Server()
        swReleased:=FALSE;
        SocketCreate server;
        SocketBind server,"@ADDRESS@",@PORT@;
        SocketListen server;
        WHILE TRUE DO
            SocketAccept server,client\Time:=WAIT_MAX;
            staged_count:=0;
            starts:=0;
            measuring:=FALSE;
            Serve;
            ! The connection is lost: nothing that it wrote may be used.
            swReleased:=FALSE;
            staged_count:=0;
            SocketClose client;
        ENDWHILE
    ERROR
        IF ERRNO=ERR_SOCK_TIMEOUT RETRY;
        swReleased:=FALSE;
        SocketClose client;
        SocketClose server;
        WaitTime 1;
        ExitCycle;
    ENDPROC

    LOCAL PROC Serve()
        WHILE TRUE DO
            IF SocketPeek(client)>=240 THEN
                SocketReceive client\Str:=line1\ReadNoOfBytes:=80\Time:=1;
                SocketReceive client\Str:=line2\ReadNoOfBytes:=80\Time:=1;
                SocketReceive client\Str:=line3\ReadNoOfBytes:=80\Time:=1;
                Answer;
            ELSE
                TellEvents;
                WaitTime 0.002;
            ENDIF
        ENDWHILE
    ERROR
        ! closed, half a message, or what cannot be read
        RETURN;
    ENDPROC

    LOCAL PROC TellEvents()
        IF swCall THEN
            swCall:=FALSE;
            swReleased:=FALSE;
            staged_count:=0;
            starts:=starts+1;
            Say "0 START "+NumToStr(starts,0),swPart,"";
        ENDIF
        IF NOT measuring RETURN;
        IF told<swFired THEN
            told:=told+1;
            SayPose "0 TRIGGER "+NumToStr(told,0)+" "+NumToStr(told,0)+" "+swSpotName{told},swAt{told};
        ELSEIF swEnded THEN
            measuring:=FALSE;
            Say "0 END "+NumToStr(told,0),"","";
        ENDIF
    ENDPROC

    LOCAL PROC Answer()
        VAR string number;
        VAR string word;
        VAR string name;
        VAR string head;
        VAR robtarget at;
        VAR pose frame;
        VAR wobjdata object;
        number:=Field(line1,1);
        word:=Field(line1,2);
        name:=Field(line1,3);
        head:=number+" "+word;
        TEST word
        CASE "HELLO":
            Say head+" 1",GetSysInfo(\SerialNo),GetSysInfo(\RobotType);
        CASE "MODE":
            Say head+" "+ModeWords(),"","";
        CASE "PING":
            Say head,"","";
        CASE "POSE":
            at:=CRobT(\TaskName:="T_ROB1"\Tool:=tool0\WObj:=wobj0);
            frame.trans:=at.trans;
            frame.rot:=at.rot;
            SayPose head,frame;
        CASE "READ":
            IF Staged_index(name)>0 THEN
                SayPose head+" "+name,staged{Staged_index(name)};
            ELSEIF Known(name,object) THEN
                SayPose head+" "+name,PoseMult(object.uframe,object.oframe);
            ELSE
                Say number+" NO READ","there is no work object "+name,"";
            ENDIF
        CASE "WRITE":
            swReleased:=FALSE;
            IF NOT Known(name,object) THEN
                Say number+" NO WRITE","there is no work object "+name,"";
            ELSEIF NOT ReadPose(frame) THEN
                Say number+" NO WRITE","the pose cannot be read","";
            ELSEIF Staged_index(name)=0 AND staged_count>=32 THEN
                Say number+" NO WRITE","more than 32 frames","";
            ELSE
                IF Staged_index(name)=0 THEN
                    staged_count:=staged_count+1;
                    staged_name{staged_count}:=name;
                ENDIF
                staged{Staged_index(name)}:=frame;
                SayPose head+" "+name,frame;
            ENDIF
        CASE "MEASURE":
            swReleased:=FALSE;
            IF name<>NumToStr(swCount,0) OR Field(line1,4)<>swSignature THEN
                Say number+" NO MEASURE","another measuring program is loaded than the project's","";
            ELSEIF swBusy THEN
                Say number+" NO MEASURE","the measuring program runs already","";
            ELSEIF ModeWords()<>"AUTO ON RUN" AND ModeWords()<>"MANR ON RUN" AND ModeWords()<>"MANF ON RUN" THEN
                Say number+" NO MEASURE","the robot is stopped","";
            ELSE
                staged_count:=0;
                told:=0;
                swFired:=0;
                swEnded:=FALSE;
                measuring:=TRUE;
                swGo:=TRUE;
                Say head+" "+name,"","";
            ENDIF
        CASE "VERDICT":
            swReleased:=FALSE;
            IF name="CORRECTED" THEN
                FOR i FROM 1 TO staged_count DO
                    IF Known(staged_name{i},object) THEN
                        object.uframe:=[[0,0,0],[1,0,0,0]];
                        object.oframe:=staged{i};
                        SetDataVal staged_name{i}\TaskName:="T_ROB1",object;
                    ENDIF
                ENDFOR
                swReleased:=TRUE;
            ENDIF
            staged_count:=0;
            Say head+" "+name,"","";
        CASE "MOVE":
            IF OpMode()=OP_AUTO OR NOT swTeaching OR NOT ReadPose(frame) THEN
                Say number+" NO MOVE","moving by command wants manual mode and SW_Teach running","";
            ELSE
                swMoveTo:=frame;
                swMove:=TRUE;
                WHILE swMove AND DOutput(sw_doMotorsOn)=1 DO
                    WaitTime 0.01;
                ENDWHILE
                IF swMove THEN
                    swMove:=FALSE;
                    Say number+" NO MOVE","the motors went off","";
                ELSE
                    Say head,"","";
                ENDIF
            ENDIF
        DEFAULT:
            Say number+" NO "+word,"unknown request","";
        ENDTEST
    ENDPROC

    LOCAL FUNC string ModeWords()
        VAR string words;
        TEST OpMode()
        CASE OP_AUTO:
            words:="AUTO";
        CASE OP_MAN_PROG:
            words:="MANR";
        CASE OP_MAN_TEST:
            words:="MANF";
        DEFAULT:
            words:="UNDEF";
        ENDTEST
        IF DOutput(sw_doEStop)=1 THEN
            words:=words+" ESTOP";
        ELSEIF DOutput(sw_doMotorsOn)=1 THEN
            words:=words+" ON";
        ELSE
            words:=words+" OFF";
        ENDIF
        IF DOutput(sw_doCycleOn)=1 RETURN words+" RUN";
        RETURN words+" HALT";
    ENDFUNC

    ! The n-th word of a line, counted from 1.
    LOCAL FUNC string Field(string line,num n)
        VAR num at:=1;
        VAR num blank;
        FOR i FROM 1 TO n DO
            IF at>StrLen(line) RETURN "";
            blank:=StrFind(line,at," \0A");
            IF i=n RETURN StrPart(line,at,blank-at);
            at:=blank+1;
        ENDFOR
        RETURN "";
    ENDFUNC

    LOCAL FUNC bool ReadPose(INOUT pose frame)
        VAR bool ok;
        ok:=StrToVal(Field(line2,1),frame.trans.x);
        ok:=StrToVal(Field(line2,2),frame.trans.y) AND ok;
        ok:=StrToVal(Field(line2,3),frame.trans.z) AND ok;
        ok:=StrToVal(Field(line3,1),frame.rot.q1) AND ok;
        ok:=StrToVal(Field(line3,2),frame.rot.q2) AND ok;
        ok:=StrToVal(Field(line3,3),frame.rot.q3) AND ok;
        ok:=StrToVal(Field(line3,4),frame.rot.q4) AND ok;
        IF ok frame.rot:=NOrient(frame.rot);
        RETURN ok;
    ENDFUNC

    LOCAL FUNC num Staged_index(string name)
        FOR i FROM 1 TO staged_count DO
            IF staged_name{i}=name RETURN i;
        ENDFOR
        RETURN 0;
    ENDFUNC

    LOCAL FUNC bool Known(string name,INOUT wobjdata object)
        GetDataVal name\TaskName:="T_ROB1",object;
        RETURN TRUE;
    ERROR
        RETURN FALSE;
    ENDFUNC

    ! A line is 79 characters and a line feed.
    LOCAL FUNC string Padded(string text)
        VAR string line;
        line:=text;
        IF StrLen(line)>79 line:=StrPart(line,1,79);
        WHILE StrLen(line)<79 DO
            line:=line+" ";
        ENDWHILE
        RETURN line+"\0A";
    ENDFUNC

    LOCAL PROC Say(string first,string second,string third)
        SocketSend client\Str:=Padded(first);
        SocketSend client\Str:=Padded(second);
        SocketSend client\Str:=Padded(third);
    ERROR
        RAISE;
    ENDPROC

    LOCAL PROC SayPose(string first,pose frame)
        VAR string place;
        VAR string turn;
        place:=NumToStr(frame.trans.x,4)+" "+NumToStr(frame.trans.y,4)+" "+NumToStr(frame.trans.z,4);
        turn:=NumToStr(frame.rot.q1,8)+" "+NumToStr(frame.rot.q2,8);
        turn:=turn+" "+NumToStr(frame.rot.q3,8)+" "+NumToStr(frame.rot.q4,8);
        Say first,place,turn;
    ERROR
        RAISE;
    ENDPROC
ENDMODULE
